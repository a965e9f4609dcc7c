// Absent is exactly the baseline, without strength nearly; at typical strength every effect is visible.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

std::vector<double> readings(const PlantModel& model) {
  return ramped_readings(model, 18000);
}

TEST(AbsentEffects, LeaveTheBaselineToTheBit) {
  const auto baseline = readings(PlantModel{});
  EXPECT_EQ(readings(parse_model("[baseline]\n", "empty.toml")), baseline);
  EXPECT_EQ(readings(parse_model("[baseline]\n[effect]\n", "empty.toml")), baseline);
  EXPECT_EQ(readings(read_model(models_folder() / "baseline.toml")), baseline);
}

TEST(AbsentEffects, WithoutStrengthOnSensorAndTissueLeaveTheBaselineToTheBit) {
  PlantModel model;
  const auto baseline = readings(model);
  model.effects.sensor_offset = SensorOffset{0.0};
  model.effects.sensor_noise = SensorNoise{0.0};
  model.effects.layer_puncture = LayerPuncture{};
  model.effects.tissue_relaxation = TissueRelaxation{};
  EXPECT_EQ(readings(model), baseline);
}

// All strengths 0, everything else typical; an effect without strength has its level or place out of reach.
template <class Effect>
Effect powerless() {
  Effect effect;
  for (const auto& parameter : Effect::parameters()) {
    if (parameter.role == Role::Strength) effect.*(parameter.member) = 0.0;
    if (parameter.role == Role::Shape || parameter.role == Role::Frequency)
      effect.*(parameter.member) = parameter.typical * parameter.si_per_unit;
    if (parameter.role == Role::Level) effect.*(parameter.member) = parameter.high * parameter.si_per_unit;
  }
  return effect;
}

TEST(AbsentEffects, WithoutStrengthAreTheBaselineToATenthOfAMicrometreUnderEitherDrive) {
  PlantModel pushed;
  pushed.baseline.drive = Drive::Force;
  for (const PlantModel& plain : {PlantModel{}, pushed}) {
    const auto baseline = readings(plain);
    for_each_typical_effect([&]<class Effect>(const Effect&) {
      EXPECT_LT(largest_difference(readings(with_effect(plain, powerless<Effect>())), baseline), 1e-7)
          << Effect::info.name;
    });
  }
}

// A thousandth of the typical strength moves the reading by about that share of the whole strength's effect.
TEST(Effects, GrowContinuouslyFromZeroStrength) {
  const auto baseline = readings(PlantModel{});
  for_each_typical_effect([&]<class Effect>(const Effect& typical) {
    Effect weak = powerless<Effect>();
    bool has_strength = false;
    for (const auto& parameter : Effect::parameters())
      if (parameter.role == Role::Strength) {
        weak.*(parameter.member) = 1e-3 * (typical.*(parameter.member));
        has_strength = true;
      }
    if (!has_strength) return;
    EXPECT_LT(largest_difference(readings(with_effect(PlantModel{}, weak)), baseline), 50e-6)
        << Effect::info.name;
  });
}

TEST(Effects, AtTypicalStrengthChangeTheReading) {
  const auto baseline = readings(PlantModel{});
  for_each_typical_effect([&]<class Effect>(const Effect& typical) {
    EXPECT_GT(largest_difference(readings(with_effect(PlantModel{}, typical)), baseline), 5e-6)
        << Effect::info.name;
  });
}

TEST(Effects, HaveUniqueNamesTextsAndParametersWithUnitsAndRanges) {
  std::set<std::string_view> names;
  const std::set<std::string_view> menu{"dc_hold",         "voltage_staircase_up_and_down",
                                        "frequency_sweep", "weight_drop",
                                        "slow_triangle",   "closed_loop_steps"};
  for_each_typical_effect([&]<class Effect>(const Effect&) {
    EXPECT_TRUE(names.insert(Effect::info.name).second) << Effect::info.name;
    EXPECT_TRUE(menu.contains(Effect::info.experiment)) << Effect::info.name;
    for (const std::string_view text :
         {Effect::info.sentence, Effect::info.equation, Effect::info.experiment, Effect::info.source})
      EXPECT_FALSE(text.empty()) << Effect::info.name;
    for (const auto& parameter : Effect::parameters()) {
      const bool pure = parameter.si_per_unit == 1.0;  // a share or an exponent carries no unit
      EXPECT_TRUE(pure || parameter.name.find('_') != std::string_view::npos) << parameter.name;
      EXPECT_LT(parameter.low, parameter.high) << parameter.name;
      EXPECT_GE(parameter.typical, parameter.low) << parameter.name;
      EXPECT_LE(parameter.typical, parameter.high) << parameter.name;
    }
  });
  EXPECT_EQ(names.size(), 36U);
}

}  // namespace
}  // namespace biopsy::sim
