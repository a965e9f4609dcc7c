// What lies between plate A and the number that is read.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

PlantModel held_still() {
  PlantModel model = bare_mass();
  model.effects.coulomb_friction = CoulombFriction{2.0};
  return model;
}

TEST(SensorLag, AStandingPlateIsReachedExponentially) {
  PlantModel model = held_still();
  model.effects.sensor_lag = SensorLag{.time = 5e-3};
  PlantState state = at_rest(model);
  state.motion.x = 2e-3;
  for (int k = 1; k <= 100; ++k) {
    state = step(model, state, {}, Seconds(1e-3));
    ASSERT_NEAR(displacement_reading(model, state), 2e-3 * -std::expm1(-k / 5.0), 1e-15);
  }
}

TEST(SensorLag, TrailsASteadyMotionByItsTime) {
  PlantModel model = bare_mass();
  model.effects.sensor_lag = SensorLag{.time = 20e-3};
  PlantState state = at_rest(model);
  state.motion.v = 0.01;
  for (int k = 0; k < 500; ++k) state = step(model, state, {}, Seconds(1e-3));
  EXPECT_NEAR(state.motion.x - displacement_reading(model, state), 0.01 * 20e-3, 0.5 * 0.01 * 1e-3);
}

TEST(SensorOffset, IsAddedToEveryReadingAndToNothingElse) {
  PlantModel model = held_still();
  model.effects.sensor_offset = SensorOffset{.offset = -0.3e-3};
  PlantState state = at_rest(model);
  EXPECT_EQ(displacement_reading(model, state), -0.3e-3);
  state.motion.x = 2e-3;
  EXPECT_DOUBLE_EQ(displacement_reading(model, state), 1.7e-3);
  EXPECT_EQ(step(model, state, {}, Seconds(1e-3)).motion.x, 2e-3);
}

std::vector<double> readings(std::uint64_t seed, int count) {
  PlantModel model = held_still();
  model.effects.sensor_noise = SensorNoise{.std = 10e-6};
  model.noise_seed = seed;
  PlantState state = at_rest(model);
  std::vector<double> out;
  for (int k = 0; k < count; ++k) {
    state = step(model, state, {}, Seconds(1e-3));
    out.push_back(displacement_reading(model, state));
  }
  return out;
}

TEST(SensorNoise, IsWhiteGaussianWithTheGivenDeviation) {
  constexpr int kCount = 100000;
  const auto noise = readings(7, kCount);
  double mean = 0.0, square = 0.0, neighbour = 0.0, within = 0.0, fourth = 0.0;
  for (int k = 0; k < kCount; ++k) {
    const double z = noise[k] / 10e-6;
    mean += z / kCount;
    square += z * z / kCount;
    fourth += z * z * z * z / kCount;
    within += (std::abs(z) < 1.0) / static_cast<double>(kCount);
    if (k > 0) neighbour += z * noise[k - 1] / 10e-6 / kCount;
  }
  const double se = 1.0 / std::sqrt(kCount);  // bounds: four standard errors
  EXPECT_NEAR(mean, 0.0, 4 * se);
  EXPECT_NEAR(square, 1.0, 4 * std::sqrt(2.0) * se);
  EXPECT_NEAR(fourth, 3.0, 4 * std::sqrt(96.0) * se);
  EXPECT_NEAR(within, 0.682689, 4 * std::sqrt(0.683 * 0.317) * se);
  EXPECT_NEAR(neighbour, 0.0, 4 * se);
}

TEST(SensorNoise, IsTheSameForTheSameSeedAndAnotherForAnother) {
  EXPECT_EQ(readings(7, 100), readings(7, 100));
  EXPECT_NE(readings(7, 100), readings(8, 100));
}

TEST(SensorNoise, NeighbouringSeedsAreNotTheSameNoiseShifted) {
  const auto a = readings(7, 5000), b = readings(8, 5001);
  for (int shift = -1; shift <= 1; ++shift) {
    double product = 0.0;
    for (int k = 1; k < 5000; ++k) product += a[k] * b[k + shift] / (10e-6 * 10e-6) / 5000;
    EXPECT_NEAR(product, 0.0, 4.5 / std::sqrt(5000.0)) << shift;
  }
}

TEST(SensorNoise, TwoLooksAtOneInstantSeeOneReading) {
  PlantModel model = held_still();
  model.effects.sensor_noise = SensorNoise{.std = 10e-6};
  const PlantState state = step(model, at_rest(model), {}, Seconds(1e-3));
  EXPECT_EQ(displacement_reading(model, state), displacement_reading(model, state));
}

}  // namespace
}  // namespace biopsy::sim
