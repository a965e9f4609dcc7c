#include "planner/plan/nominal_stage.hpp"

#include "robot/common/config_error.hpp"
#include "robot/common/files/toml_reader.hpp"

namespace biopsy::planner {
namespace {

struct Entry {
  const char* name;
  double NominalStage::*member;
  double low, high;
};

constexpr Entry kBaseline[] = {{"K", &NominalStage::K, 0.01, 1.0},
                               {"tau", &NominalStage::tau, 1e-3, 1e6},
                               {"eps_film", &NominalStage::eps_film, 1.0, 100.0},
                               {"d_film", &NominalStage::d_film, 1e-6, 1e-2},
                               {"L0", &NominalStage::L0, 1e-3, 1.0},
                               {"V0", &NominalStage::V0, 1e-10, 1e-4},
                               {"H_0", &NominalStage::H_0, 0.0, 0.1},
                               {"n", &NominalStage::n, 1.0, 1000.0},
                               {"tau_h", &NominalStage::tau_h, 1e-5, 100.0},
                               {"k", &NominalStage::k, 1e-3, 1e7},
                               {"fixture_mass", &NominalStage::fixture_mass, 1e-5, 100.0},
                               {"m_B", &NominalStage::m_B, 0.0, 100.0}};

void read_effects(TomlTable effects, NominalStage& stage) {
  if (effects.has("film_hysteresis"))
    stage.film_loss = effects.table("film_hysteresis").number("loss_V", 0.0, 8000.0, "V");
  if (effects.has("charge_retention")) {
    TomlTable retention = effects.table("charge_retention");
    stage.retained_share = retention.number("share", 0.0, 0.95);
    stage.retained_time = retention.number("time_s", 1e-3, 1e5, "s");
  }
}

}  // namespace

NominalStage read_nominal_stage(const std::filesystem::path& model) {
  TomlTable root = TomlTable::parse(read_file(model, "give the path of a TOML file"), model.string());
  NominalStage stage;
  TomlTable baseline = root.table("baseline");
  if (baseline.has("drive") && baseline.text("drive") != "stack")
    throw ConfigError("a stage that a measured force drives cannot be planned for", baseline.place("drive"),
                      "give the model of a stack");
  for (const Entry& entry : kBaseline)
    if (baseline.has(entry.name)) stage.*(entry.member) = baseline.number(entry.name, entry.low, entry.high);
  if (root.has("effect")) read_effects(root.table("effect"), stage);
  return stage;
}

}  // namespace biopsy::planner
