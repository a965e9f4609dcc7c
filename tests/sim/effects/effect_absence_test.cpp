// Absent is exactly the baseline; present without strength is the baseline too; present at typical strength
// shows.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

std::vector<double> readings(const PlantModel& model) {
  PlantState state = at_rest(model);
  std::vector<double> out;
  for (int k = 0; k < 18000; ++k) {
    const double u = ramps_and_flips(k);
    state = step(model, state, {.voltage = u, .force = 1e-4 * u}, Seconds(1e-3));
    out.push_back(displacement_reading(model, state));
  }
  return out;
}

TEST(AbsentEffects, LeaveTheBaselineToTheBit) {
  const auto baseline = readings(PlantModel{});
  EXPECT_EQ(readings(parse_model("[baseline]\n", "empty.toml")), baseline);
  EXPECT_EQ(readings(parse_model("[baseline]\n[effect]\n", "empty.toml")), baseline);
  EXPECT_EQ(readings(read_model(models_folder() / "baseline.toml")), baseline);
}

TEST(PowerlessEffects, OnSensorAndTissueLeaveTheBaselineToTheBit) {
  PlantModel model;
  const auto baseline = readings(model);
  model.effects.sensor_offset = SensorOffset{0.0};
  model.effects.sensor_noise = SensorNoise{0.0};
  model.effects.layer_puncture = LayerPuncture{};
  model.effects.tissue_relaxation = TissueRelaxation{};
  EXPECT_EQ(readings(model), baseline);
}

TEST(PowerlessEffects, OnStageAndPouchLeaveTheBaselineToAFractionOfAMicrometre) {
  const auto baseline = readings(PlantModel{});
  PlantModel coulomb, stribeck, shaft, play;
  coulomb.effects.coulomb_friction = CoulombFriction{0.0};
  stribeck.effects.stribeck_friction = StribeckFriction{};
  shaft.effects.shaft_friction = ShaftFriction{};
  play.effects.zipping_hysteresis = ZippingHysteresis{0.0};
  EXPECT_LT(largest_difference(readings(coulomb), baseline), 1e-7);
  EXPECT_LT(largest_difference(readings(stribeck), baseline), 1e-7);
  EXPECT_LT(largest_difference(readings(shaft), baseline), 1e-7);
  EXPECT_LT(largest_difference(readings(play), baseline), 1e-6);  // the edge of the play is its whole
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

TEST(PowerlessEffects, AreEachTheBaselineToATenthOfAMicrometreUnderEitherDrive) {
  PlantModel pushed;
  pushed.baseline.drive = Drive::Force;
  for (const PlantModel& plain : {PlantModel{}, pushed}) {
    const auto baseline = readings(plain);
    Effects library;
    for_each_effect(library, [&](auto& slot) {
      using Effect = typename std::decay_t<decltype(slot)>::value_type;
      PlantModel model = plain;
      for_each_effect(model.effects, [&](auto& own) {
        if constexpr (std::is_same_v<decltype(own), decltype(slot)>) own = powerless<Effect>();
      });
      EXPECT_LT(largest_difference(readings(model), baseline), 1e-7) << Effect::info.name;
    });
  }
}

// A thousandth of the typical strength moves the reading by about that share of what the whole strength does.
TEST(Effects, GrowFromNothing) {
  const auto baseline = readings(PlantModel{});
  Effects library;
  for_each_effect(library, [&](auto& slot) {
    using Effect = typename std::decay_t<decltype(slot)>::value_type;
    PlantModel model;
    bool has_strength = false;
    for_each_effect(model.effects, [&](auto& own) {
      if constexpr (std::is_same_v<decltype(own), decltype(slot)>) {
        own = powerless<Effect>();
        for (const auto& parameter : Effect::parameters())
          if (parameter.role == Role::Strength) {
            (*own).*(parameter.member) = 1e-3 * parameter.typical * parameter.si_per_unit;
            has_strength = true;
          }
      }
    });
    if (!has_strength) return;
    EXPECT_LT(largest_difference(readings(model), baseline), 50e-6) << Effect::info.name;
  });
}

TEST(Effects, EachAtItsTypicalStrengthShowsInTheReading) {
  const auto baseline = readings(PlantModel{});
  Effects library;
  for_each_effect(library, [&](auto& slot) {
    using Effect = typename std::decay_t<decltype(slot)>::value_type;
    slot.emplace();
    for (const auto& parameter : Effect::parameters())
      (*slot).*(parameter.member) = parameter.typical * parameter.si_per_unit;
    PlantModel model;
    for_each_effect(model.effects, [&](auto& own) {
      if constexpr (std::is_same_v<decltype(own), decltype(slot)>) own = slot;
    });
    EXPECT_GT(largest_difference(readings(model), baseline), 5e-6) << Effect::info.name;
  });
}

TEST(Effects, EachSaysWhatItIsAndItsParametersHaveUnitsAndUsableRanges) {
  std::set<std::string_view> names;
  const std::set<std::string_view> menu{"dc_hold",         "voltage_staircase_up_and_down",
                                        "frequency_sweep", "weight_drop",
                                        "slow_triangle",   "closed_loop_steps"};
  Effects library;
  for_each_effect(library, [&](auto& slot) {
    using Effect = typename std::decay_t<decltype(slot)>::value_type;
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
  EXPECT_EQ(names.size(), 25U);
}

}  // namespace
}  // namespace biopsy::sim
