#include "sim/plant/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "robot/common/config_error.hpp"
#include "robot/common/files/toml_reader.hpp"
#include "sim/plant/baseline_entries.hpp"
#include "sim/term/term_text.hpp"

namespace biopsy::sim {
namespace {

constexpr std::size_t kLongestTermName = 40;
constexpr double kLargestCoefficient = 1e30;  // the force is what is limited

// A value; its std and source go to the notes under `key`.
double read_value(TomlTable& table, std::string_view name, double low, double high, const std::string& key,
                  ModelNotes& notes) {
  const double value = table.number(name, low, high);
  if (!table.holds_table(name)) return value;
  TomlTable described = table.table(name);
  ValueNote note;
  if (described.has("std")) note.std = described.number("std", 0.0, std::numeric_limits<double>::max());
  if (described.has("source")) note.source = described.text("source");
  if (note != ValueNote{}) notes.values[key] = note;
  return value;
}

void read_drive(TomlTable& table, Baseline& baseline) {
  const std::string word = table.text("drive");
  if (word != "stack" && word != "force")
    throw ConfigError("`drive` is neither \"stack\" nor \"force\"", table.where(), "write drive = \"stack\"");
  baseline.drive = word == "force" ? Drive::Force : Drive::Stack;
}

// Values that the file leaves out keep the reference.
void read_baseline(TomlTable table, NotedModel& out) {
  Baseline& baseline = out.model.baseline;
  if (table.has("drive")) read_drive(table, baseline);
  for (const BaselineEntry& entry : baseline_entries()) {
    if (table.has(entry.name))
      baseline.*(entry.member) =
          read_value(table, entry.name, entry.low, entry.high, std::string(entry.name), out.notes);
  }
  if (baseline.drive == Drive::Force) out.notes.T.reset();  // given by the data set's rows
  if (table.has("T")) out.notes.T = read_value(table, "T", 1e-5, 0.05, "T", out.notes);
}

// An effect that is present must give all its parameters but the optional ones.
template <class Effect>
Effect read_effect(TomlTable table, ModelNotes& notes) {
  Effect effect;
  for (const auto& parameter : Effect::parameters()) {
    effect.*(parameter.member) = 0.0;
    if (!table.has(parameter.name) && parameter.optional) continue;
    effect.*(parameter.member) =
        parameter.si_per_unit * read_value(table, parameter.name, parameter.low, parameter.high,
                                           fmt::format("{}.{}", Effect::info.name, parameter.name), notes);
  }
  return effect;
}

void read_effects(TomlTable table, NotedModel& out) {
  for_each_effect(out.model.effects, [&](auto& slot) {
    using Effect = typename std::decay_t<decltype(slot)>::value_type;
    if (table.has(Effect::info.name)) slot = read_effect<Effect>(table.table(Effect::info.name), out.notes);
  });
}

bool is_term_name(const std::string& name) {
  const auto fits = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  bool own = !name.empty() && name.size() <= kLongestTermName && std::ranges::all_of(name, fits);
  const Effects none;
  for_each_effect(none, [&]<class E>(const std::optional<E>&) { own = own && name != E::info.name; });
  return own;
}

// A coefficient is in SI; a unit that stands beside it must be that of its product.
Term read_term(TomlTable table, const std::string& name, Drive drive, ModelNotes& notes) {
  const bool on_stack = drive == Drive::Stack;
  Term term = read_term_frame(table, name, on_stack);
  for (std::size_t i = 0; i < term.parts.size(); ++i) {
    TermPart& part = term.parts[i];
    const std::string letter = coefficient_name(i), unit = coefficient_unit(part.powers, on_stack);
    part.coefficient = read_value(table, letter, -kLargestCoefficient, kLargestCoefficient,
                                  fmt::format("{}.{}", name, letter), notes);
    if (!table.holds_table(letter)) continue;
    TomlTable described = table.table(letter);
    if (described.has("unit") && described.text("unit") != unit)
      described.refuse("unit", fmt::format("is not that of \"{}\"", product_text(part.powers)),
                       fmt::format("give the coefficient in {}", unit));
  }
  check_term_force(term, table);
  return term;
}

void read_terms(TomlTable table, NotedModel& out) {
  const std::vector<std::string> names = table.names();
  if (names.size() > kMostTerms)
    throw ConfigError(fmt::format("{} terms", names.size()), table.where(),
                      fmt::format("keep at most {}", kMostTerms));
  for (const std::string& name : names) {
    if (!is_term_name(name))
      table.refuse(name, "is no name for a term",
                   "use small letters, digits and _, and not the name of an effect");
    out.model.terms.push_back(read_term(table.table(name), name, out.model.baseline.drive, out.notes));
  }
}

Brake read_brake(TomlTable table) {
  Brake brake;
  brake.holding_N = table.number("holding_N", 0.1, 1000.0, "N");
  brake.stiffness = table.number("stiffness_N_per_mm", 0.1, 500.0, "N/mm") * 1e3;
  brake.damping = table.number("damping_N_s_per_m", 0.0, 1000.0, "N s/m");
  brake.engage_s = table.number("engage_ms", 0.0, 100.0, "ms") * 1e-3;
  brake.release_s = table.number("release_ms", 0.0, 100.0, "ms") * 1e-3;
  return brake;
}

Correlations read_correlations(TomlTable table, const ModelNotes& notes) {
  Correlations out;
  out.values = table.texts("values");
  out.lower = table.numbers("lower", -1.0, 1.0);
  const std::set<std::string> once(out.values.begin(), out.values.end());
  for (const std::string& name : out.values) {
    const auto note = notes.values.find(name);
    if (note == notes.values.end() || !note->second.std || once.size() != out.values.size())
      throw ConfigError(fmt::format("`{}` has no deviation in this file, or stands twice", name),
                        table.place("values"), "name values that have a `std`, each once");
  }
  const std::size_t n = out.values.size();
  if (out.lower.size() != (n < 2 ? 0 : n * (n - 1) / 2))
    throw ConfigError(fmt::format("{} numbers for {} values", out.lower.size(), n), table.place("lower"),
                      "give for each value its correlations with those before it, row by row");
  return out;
}

NotedModel model_of(TomlTable& root) {
  NotedModel out;
  if (root.has("title")) out.notes.title = root.text("title");
  read_baseline(root.table("baseline"), out);
  if (root.has("effect")) read_effects(root.table("effect"), out);
  if (root.has("term")) read_terms(root.table("term"), out);
  if (root.has("brake")) out.model.brake = read_brake(root.table("brake"));
  if (root.has("correlation"))
    out.notes.correlations = read_correlations(root.table("correlation"), out.notes);
  return out;
}

}  // namespace

NotedModel parse_noted_model(const std::string& text, const std::string& name) {
  return parse_toml(text, name, model_of);
}

NotedModel read_noted_model(const std::filesystem::path& file) {
  return read_toml(file, model_of);
}

PlantModel parse_model(const std::string& text, const std::string& name) {
  return parse_noted_model(text, name).model;
}

PlantModel read_model(const std::filesystem::path& file) {
  return read_noted_model(file).model;
}

}  // namespace biopsy::sim
