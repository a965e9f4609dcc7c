#include "sim/plant/model_text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <set>

#include "robot/common/config_error.hpp"
#include "robot/common/files/toml_reader.hpp"
#include "sim/plant/baseline_entries.hpp"
#include "sim/term/term_text.hpp"

namespace biopsy::sim {
namespace {

constexpr const char* kNameInMessages = "the model to be written";

double rounded_to_digits(double value, int digits) {
  const std::string text = fmt::format("{:.{}e}", value, digits - 1);
  double out = value;
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out;
}

// The lines of one file, and which notes were written.
class ModelText {
 public:
  explicit ModelText(const ModelNotes& notes) : notes_(notes) {
    if (!notes.title.empty()) text_ = fmt::format("title = {}\n\n", quoted(notes.title));
  }

  void line(std::string_view words) { text_ += fmt::format("{}\n", words); }

  void value(std::string_view name, const std::string& number, const std::string& key,
             const std::string& comment = "", const std::string& unit = "") {
    std::string words = fmt::format("{} = {}", name, number);
    const auto note = notes_.values.find(key);
    const bool noted = note != notes_.values.end();
    if (noted || !unit.empty()) {
      words = fmt::format("{} = {{ value = {}", name, number);
      if (!unit.empty()) words += fmt::format(", unit = {}", quoted(unit));
      if (noted && note->second.std) words += fmt::format(", std = {}", *note->second.std);
      if (noted && !note->second.source.empty())
        words += fmt::format(", source = {}", quoted(note->second.source));
      words += " }";
      if (noted) noted_.insert(key);
    }
    line(comment.empty() ? words : fmt::format("{:<22} # {}", words, comment));
  }

  std::string finished() const {
    for (const auto& [key, note] : notes_.values)
      if (!noted_.contains(key))
        throw ConfigError(
            fmt::format("a note on `{}`, which the model does not hold", key), kNameInMessages,
            "name a value of [baseline], or EFFECT.PARAMETER of an effect or term that is present");
    return text_;
  }

 private:
  const ModelNotes& notes_;
  std::string text_;
  std::set<std::string> noted_;
};

void write_baseline(const Baseline& baseline, const ModelNotes& notes, ModelText& text) {
  text.line("[baseline]");
  if (baseline.drive == Drive::Force) text.line("drive = \"force\"");
  for (const BaselineEntry& entry : baseline_entries()) {
    const double value = baseline.*(entry.member);
    const bool noted = notes.values.contains(std::string(entry.name));
    if (!entry.acts_in(baseline.drive) && value == Baseline{}.*(entry.member) && !noted) continue;
    text.value(entry.name, fmt::format("{}", value), std::string(entry.name),
               fmt::format("{}{}{}", entry.unit, entry.unit.empty() ? "" : ", ", entry.meaning));
  }
  if (notes.T) text.value("T", fmt::format("{}", *notes.T), "T", "s, control period");
}

template <class Effect>
void write_effect(const Effect& effect, const ModelNotes& notes, ModelText& text) {
  text.line(fmt::format("\n# {}\n[effect.{}]", Effect::info.sentence, Effect::info.name));
  for (const auto& p : Effect::parameters()) {
    const std::string key = fmt::format("{}.{}", Effect::info.name, p.name);
    if (p.optional && effect.*(p.member) == 0.0 && !notes.values.contains(key)) continue;
    text.value(p.name, number_in_unit(effect.*(p.member), p.si_per_unit, p.low, p.high), key);
  }
}

void write_term(const Term& term, bool on_stack, ModelText& text) {
  text.line(
      fmt::format("\n# No effect of the library: a force on plate A, N, up.\n[term.{}]\nexpression = {}",
                  term.name, quoted(expression_text(term.parts))));
  for (std::size_t i = 0; i < term.parts.size(); ++i) {
    const TermPart& part = term.parts[i];
    text.value(coefficient_name(i), fmt::format("{}", part.coefficient),
               fmt::format("{}.{}", term.name, coefficient_name(i)), "",
               coefficient_unit(part.powers, on_stack));
  }
  for (const TermRangeKey& key : range_keys(term.parts, on_stack)) {
    const auto end = [&](double si) {
      return number_in_unit(si, key.si_per_unit, -key.largest, key.largest);
    };
    const TermRange& range = term.seen.*(key.range);
    text.line(fmt::format("{} = [{}, {}]", key.name, end(range.low), end(range.high)));
  }
  if (term.memory_time > 0.0) text.line(fmt::format("memory_s = {}", term.memory_time));
  if (term.exponent > 0.0) text.line(fmt::format("n = {}", term.exponent));
  if (term.period > 0.0)
    text.line(fmt::format("period_mm = {}",
                          number_in_unit(term.period, 1e-3, kShortestPeriod_mm, kLongestPeriod_mm)));
}

void write_brake(const Brake& brake, ModelText& text) {
  text.line("\n# Locks the needle for an image; no part of the paper's stage.\n[brake]");
  const auto value = [&](std::string_view name, double number, std::string_view comment) {
    text.line(fmt::format("{:<22} # {}", fmt::format("{} = {}", name, number), comment));
  };
  value("holding_N", brake.holding_N, "N, slips beyond");
  value("stiffness_N_per_mm", brake.stiffness * 1e-3, "N/mm, of the clamped parts");
  value("damping_N_s_per_m", brake.damping, "N s/m");
  value("engage_ms", brake.engage_s * 1e3, "ms, from the command until it grips");
  value("release_ms", brake.release_s * 1e3, "ms, until it has let go");
}

// Left out where a value has no deviation any more.
void write_correlations(const ModelNotes& notes, ModelText& text) {
  if (!notes.correlations) return;
  const Correlations& all = *notes.correlations;
  for (const std::string& name : all.values) {
    const auto note = notes.values.find(name);
    if (note == notes.values.end() || !note->second.std) return;
  }
  std::string names;
  for (const std::string& name : all.values) names += (names.empty() ? "" : ", ") + quoted(name);
  text.line("\n# Of the deviations above: each value with those before it, row by row.\n[correlation]");
  text.line("values = [" + names + "]\nlower = [");
  for (std::size_t i = 1; i < all.values.size(); ++i) {
    std::string row = " ";
    for (std::size_t j = 0; j < i; ++j) row += fmt::format(" {},", all.between(i, j));
    text.line(row);
  }
  text.line("]");
}

}  // namespace

std::string number_in_unit(double si, double si_per_unit, double low, double high) {
  const double nearest = si / si_per_unit;
  // A value that a fit left at a limit, by way of its logarithm, misses it by some last bits.
  constexpr double kRounding = 1e-13;
  const auto is_inside = [&](double number) { return number >= low && number <= high; };
  for (const double edge : {low, high})
    if (!is_inside(nearest) && std::abs(nearest - edge) <= kRounding * std::abs(edge))
      return fmt::format("{}", edge);
  const auto reads_back = [&](double number) { return number * si_per_unit == si; };
  for (int digits = 1; digits <= 17; ++digits)
    if (const double number = rounded_to_digits(nearest, digits); reads_back(number))
      return fmt::format("{}", number);
  for (const double beside : {std::nextafter(nearest, -HUGE_VAL), std::nextafter(nearest, HUGE_VAL)})
    if (reads_back(beside) && is_inside(beside)) return fmt::format("{}", beside);
  return fmt::format("{}", nearest);
}

std::string model_toml(const PlantModel& model, const ModelNotes& notes) {
  ModelText text(notes);
  write_baseline(model.baseline, notes, text);
  for_each_effect(model.effects, [&](const auto& slot) {
    if (slot) write_effect(*slot, notes, text);
  });
  for (const Term& term : model.terms) write_term(term, model.baseline.drive == Drive::Stack, text);
  if (model.brake) write_brake(*model.brake, text);
  write_correlations(notes, text);
  std::string out = text.finished();
  parse_model(out, kNameInMessages);  // refuses what a reader would refuse
  return out;
}

}  // namespace biopsy::sim
