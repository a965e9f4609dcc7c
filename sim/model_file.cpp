#include "sim/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "robot/messages/setup_error.hpp"
#include "sim/toml_values.hpp"

namespace biopsy::sim {
namespace {

// What [baseline] may hold: name as in the reference model, member, sensible range (SI).
struct BaselineEntry {
  std::string_view name;
  double Baseline::*member;
  double low, high;
};

constexpr std::array kBaselineEntries{BaselineEntry{"K", &Baseline::K, 0.01, 2.0},
                                      BaselineEntry{"tau", &Baseline::tau, 1e-3, 1e6},
                                      BaselineEntry{"eps_film", &Baseline::eps_film, 1.0, 100.0},
                                      BaselineEntry{"d_film", &Baseline::d_film, 1e-6, 1e-2},
                                      BaselineEntry{"L0", &Baseline::L0, 1e-3, 1.0},
                                      BaselineEntry{"V0", &Baseline::V0, 1e-10, 1e-3},
                                      BaselineEntry{"H_0", &Baseline::H_0, 0.0, 0.05},
                                      BaselineEntry{"n", &Baseline::n, 1.0, 1000.0},
                                      BaselineEntry{"tau_h", &Baseline::tau_h, 1e-3, 10.0},
                                      BaselineEntry{"k", &Baseline::k, 0.0, 1e6},
                                      BaselineEntry{"c_k", &Baseline::c_k, 0.0, 1e3},
                                      BaselineEntry{"c_s", &Baseline::c_s, 0.0, 1e4},
                                      BaselineEntry{"fixture_mass", &Baseline::fixture_mass, 1e-4, 100.0},
                                      BaselineEntry{"m_B", &Baseline::m_B, 0.0, 100.0},
                                      BaselineEntry{"m", &Baseline::m, 1e-4, 1e4},
                                      BaselineEntry{"C1", &Baseline::C1, 1e-13, 1e-3},
                                      BaselineEntry{"T", nullptr, 1e-5, 0.05},
                                      BaselineEntry{"g", &Baseline::g, 0.0, 100.0}};

void read_drive(TomlTable& table, Baseline& baseline) {
  const std::string word = table.text("drive");
  if (word != "stack" && word != "force")
    throw SetupError("`drive` is neither \"stack\" nor \"force\"", table.where(), "write drive = \"stack\"");
  baseline.drive = word == "force" ? Drive::Force : Drive::Stack;
}

// What a file leaves out keeps the reference value.
void read_baseline(TomlTable table, Baseline& baseline) {
  if (table.has("drive")) read_drive(table, baseline);
  for (const BaselineEntry& entry : kBaselineEntries) {
    table.ignore(entry.name);
    if (!table.has(entry.name)) continue;
    const double value = table.number(entry.name, entry.low, entry.high);
    if (entry.member != nullptr) baseline.*(entry.member) = value;
  }
  table.refuse_rest();
}

// An effect that is present gives all its parameters: half an effect is a mistake.
template <class Effect>
Effect read_effect(TomlTable table) {
  Effect effect;
  for (const auto& parameter : Effect::parameters())
    effect.*(parameter.member) =
        table.number(parameter.name, parameter.low, parameter.high) * parameter.si_per_unit;
  table.refuse_rest();
  return effect;
}

void read_effects(TomlTable table, Effects& effects) {
  for_each_effect(effects, [&](auto& slot) {
    using Effect = typename std::decay_t<decltype(slot)>::value_type;
    if (table.has(Effect::info.name)) slot = read_effect<Effect>(table.table(Effect::info.name));
    table.ignore(Effect::info.name);
  });
  table.refuse_rest();
}

PlantModel model_of(TomlTable root) {
  PlantModel model;
  root.ignore("title");
  read_baseline(root.table("baseline"), model.baseline);
  root.ignore("effect");
  if (root.has("effect")) read_effects(root.table("effect"), model.effects);
  root.refuse_rest();
  return model;
}

}  // namespace

PlantModel parse_model(const std::string& text, const std::string& name) {
  return model_of(parse_toml(text, name));
}

PlantModel read_model(const std::filesystem::path& file) {
  return model_of(read_toml(file));
}

}  // namespace biopsy::sim
