// Halving the integrator's step must not move the reading by a micrometre, whatever effect is there.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

std::vector<double> plant_readings(PlantModel model, double internal_step) {
  model.internal_step = internal_step;
  std::vector<double> out;
  PlantState state = at_rest(model);
  for (int k = 0; k < 20000; ++k) {
    const double u = ramps_and_flips(k);
    state = step(model, state, {.voltage = u, .force = 1e-4 * std::abs(u)}, Seconds(1e-3));
    out.push_back(displacement_reading(model, state));
  }
  return out;
}

TEST(EffectConvergence, HalvingTheStepMovesNoReadingByAMicrometreAtTypicalStrength) {
  PlantModel pushed = bare_mass(0.6, 140.0);
  for (const PlantModel& plain : {PlantModel{}, pushed}) {
    Effects library;
    for_each_effect(library, [&](auto& slot) {
      using Effect = typename std::decay_t<decltype(slot)>::value_type;
      PlantModel model = plain;
      for_each_effect(model.effects, [&](auto& own) {
        if constexpr (std::is_same_v<decltype(own), decltype(slot)>) {
          own.emplace();
          for (const auto& parameter : Effect::parameters())
            (*own).*(parameter.member) = parameter.typical * parameter.si_per_unit;
        }
      });
      const double moved = largest_difference(plant_readings(model, 1e-3), plant_readings(model, 0.5e-3));
      EXPECT_LT(moved, 1e-6) << Effect::info.name;
      const std::string drive = plain.baseline.drive == Drive::Stack ? "stack_" : "force_";
      testing::Test::RecordProperty(drive + std::string(Effect::info.name) + "_nm",
                                    static_cast<int>(moved * 1e9));
    });
  }
}

}  // namespace
}  // namespace biopsy::sim
