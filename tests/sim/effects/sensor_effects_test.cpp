// Effects between plate A and the reading.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

PlantModel held_still() {
  const PlantModel model = with_effect(bare_mass(), CoulombFriction{2.0});
  return model;
}

TEST(SensorLag, ApproachesAStationaryPlateExponentially) {
  const PlantModel model = with_effect(held_still(), SensorLag{.time = 5e-3});
  PlantState state = at_rest(model);
  state.motion.x = 2e-3;
  for (int k = 1; k <= 100; ++k) {
    state = step(model, state, {}, Seconds(1e-3));
    ASSERT_NEAR(displacement_reading(model, state), 2e-3 * -std::expm1(-k / 5.0), 1e-15);
  }
}

TEST(SensorLag, TrailsASteadyMotionByItsTime) {
  const PlantModel model = with_effect(bare_mass(), SensorLag{.time = 20e-3});
  PlantState state = at_rest(model);
  state.motion.v = 0.01;
  for (int k = 0; k < 500; ++k) state = step(model, state, {}, Seconds(1e-3));
  EXPECT_NEAR(state.motion.x - displacement_reading(model, state), 0.01 * 20e-3, 0.5 * 0.01 * 1e-3);
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

TEST(SensorNoise, RepeatedReadingsOfOneInstantAreEqual) {
  const PlantModel model = with_effect(held_still(), SensorNoise{.std = 10e-6});
  const PlantState state = step(model, at_rest(model), {}, Seconds(1e-3));
  EXPECT_EQ(displacement_reading(model, state), displacement_reading(model, state));
}

// Readings of a plate on a prescribed path.
template <class Path>
std::vector<double> read_along(const PlantModel& model, int count, const Path& path) {
  PlantState state = at_rest(model);
  std::vector<double> out;
  for (int k = 0; k < count; ++k) {
    state.motion.x = path(k * 1e-3);
    state.motion.v = (path((k + 1) * 1e-3) - path(k * 1e-3)) / 1e-3;
    out.push_back(displacement_reading(model, state));
    state = step(model, state, {}, Seconds(1e-3));
  }
  return out;
}

TEST(Backlash, OpensALoopOfItsWidthAfterAReversal) {
  const PlantModel model = with_effect(bare_mass(), Backlash{0.2e-3});
  const auto triangle = [](double t) { return t < 1 ? 2e-3 * t : t < 3 ? 2e-3 * (2 - t) : 2e-3 * (t - 4); };
  const auto reading = read_along(model, 4000, triangle);
  EXPECT_EQ(reading[40], 0.0);                        // still inside the play, centred at the start
  EXPECT_NEAR(reading[500], 1e-3 - 0.1e-3, 1e-12);    // going up
  EXPECT_NEAR(reading[1050], 2e-3 - 0.1e-3, 2.1e-6);  // crossing the play: still
  EXPECT_NEAR(reading[1500], 1e-3 + 0.1e-3, 1e-12);   // going down
  EXPECT_NEAR(reading[1500] - reading[500], 0.2e-3, 1e-12);
}

TEST(SensorDelay, IsTheRampShifted) {
  const PlantModel model = with_effect(bare_mass(), SensorLag{.time = 0.0, .delay = 8e-3});
  const auto reading = read_along(model, 300, [](double t) { return 0.02 * t; });
  for (int k = 60; k < 300; ++k) ASSERT_NEAR(reading[k], 0.02 * (k - 8) * 1e-3, 1e-9) << k;
}

TEST(SensorDelay, IsTheSineShiftedAndNeverLarger) {
  for (const double delay : {2e-3, 10e-3, 30e-3}) {
    PlantModel model = bare_mass();
    model.effects.sensor_lag = SensorLag{.time = 0.0, .delay = delay};
    const double w = 2 * std::numbers::pi * 3.0;
    const auto reading = read_along(model, 3000, [&](double t) { return 1e-3 * std::sin(w * t); });
    double worst = 0.0, largest = 0.0;
    for (int k = 1000; k < 3000; ++k) {
      worst = std::max(worst, std::abs(reading[k] - 1e-3 * std::sin(w * (k * 1e-3 - delay))));
      largest = std::max(largest, std::abs(reading[k]));
    }
    EXPECT_LT(worst, 1e-3 * (2 * std::pow(w * delay, 5) / 720 + 1e-4)) << delay;  // Pade's phase error
    EXPECT_LT(largest, 1e-3 * (1 + 1e-3)) << delay;
  }
}

TEST(SensorLag, AndDelayAddUp) {
  const PlantModel model = with_effect(bare_mass(), SensorLag{.time = 5e-3, .delay = 3e-3});
  const auto reading = read_along(model, 500, [](double t) { return 0.01 * t; });
  EXPECT_NEAR(reading[400], 0.01 * (0.4 - 0.008), 1e-9);
}

TEST(SensorLag, ShorterThanAnyStepIsNoLag) {
  const PlantModel model = with_effect(bare_mass(), SensorLag{.time = 1e-9, .delay = 1e-9});
  const auto reading = read_along(model, 300, [](double t) { return 1e-3 * std::sin(20 * t); });
  for (int k = 1; k < 300; ++k) ASSERT_NEAR(reading[k], 1e-3 * std::sin(20 * k * 1e-3), 1e-9) << k;
}

TEST(SensorLag, WithoutADelayInTheFileHasNone) {
  const PlantModel model = parse_model("[baseline]\n[effect.sensor_lag]\ntime_ms = 1.5\n", "m.toml");
  EXPECT_EQ(model.effects.sensor_lag->delay, 0.0);
  EXPECT_DOUBLE_EQ(model.effects.sensor_lag->time, 1.5e-3);
}

TEST(SensorScale, MultipliesAndOffsetIsAddedAfterItAndNeitherMovesThePlate) {
  PlantModel model = bare_mass();
  model.effects.sensor_scale = SensorScale{0.1};
  model.effects.sensor_offset = SensorOffset{0.5e-3};
  PlantState state = at_rest(model);
  state.motion.x = 2e-3;
  EXPECT_DOUBLE_EQ(displacement_reading(model, state), 2e-3 * 1.1 + 0.5e-3);
  EXPECT_EQ(step(model, state, {}, Seconds(1e-3)).motion.x, 2e-3);
}

TEST(SensorDrift, BeginsWithItsRateAndSettles) {
  const PlantModel model = with_effect(bare_mass(), SensorDrift{.rate = 2e-6, .settles = 5.0});
  const auto reading = read_along(model, 60001, [](double) { return 0.0; });
  EXPECT_NEAR((reading[10] - reading[0]) / 0.010, 2e-6, 2e-3 * 2e-6);
  EXPECT_NEAR(reading[5000], 10e-6 * (1 - std::exp(-1.0)), 1e-11);
  EXPECT_NEAR(reading[60000], 10e-6, 1e-4 * 10e-6);
}

}  // namespace
}  // namespace biopsy::sim
