// Play, delay, scale and drift between plate A and the number that is read.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

// A plate that goes exactly where it is told.
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
  PlantModel model = bare_mass();
  model.effects.backlash = Backlash{0.2e-3};
  const auto triangle = [](double t) { return t < 1 ? 2e-3 * t : t < 3 ? 2e-3 * (2 - t) : 2e-3 * (t - 4); };
  const auto reading = read_along(model, 4000, triangle);
  EXPECT_EQ(reading[40], 0.0);                        // still inside the play, centred at the start
  EXPECT_NEAR(reading[500], 1e-3 - 0.1e-3, 1e-12);    // going up
  EXPECT_NEAR(reading[1050], 2e-3 - 0.1e-3, 2.1e-6);  // crossing the play: still
  EXPECT_NEAR(reading[1500], 1e-3 + 0.1e-3, 1e-12);   // going down
  EXPECT_NEAR(reading[1500] - reading[500], 0.2e-3, 1e-12);
}

TEST(SensorDelay, IsTheRampShifted) {
  PlantModel model = bare_mass();
  model.effects.sensor_lag = SensorLag{.time = 0.0, .delay = 8e-3};
  const auto reading = read_along(model, 300, [](double t) { return 0.02 * t; });
  for (int k = 60; k < 300; ++k) ASSERT_NEAR(reading[k], 0.02 * (k - 8) * 1e-3, 1e-9) << k;
}

TEST(SensorDelay, IsTheSineShiftedAndNeverLouder) {
  for (const double delay : {2e-3, 10e-3, 30e-3}) {
    PlantModel model = bare_mass();
    model.effects.sensor_lag = SensorLag{.time = 0.0, .delay = delay};
    const double w = 2 * std::numbers::pi * 3.0;
    const auto reading = read_along(model, 3000, [&](double t) { return 1e-3 * std::sin(w * t); });
    double worst = 0.0, loudest = 0.0;
    for (int k = 1000; k < 3000; ++k) {
      worst = std::max(worst, std::abs(reading[k] - 1e-3 * std::sin(w * (k * 1e-3 - delay))));
      loudest = std::max(loudest, std::abs(reading[k]));
    }
    EXPECT_LT(worst, 1e-3 * (2 * std::pow(w * delay, 5) / 720 + 1e-4)) << delay;  // Pade's phase error
    EXPECT_LT(loudest, 1e-3 * (1 + 1e-3)) << delay;
  }
}

TEST(SensorLag, AndDelayAddUp) {
  PlantModel model = bare_mass();
  model.effects.sensor_lag = SensorLag{.time = 5e-3, .delay = 3e-3};
  const auto reading = read_along(model, 500, [](double t) { return 0.01 * t; });
  EXPECT_NEAR(reading[400], 0.01 * (0.4 - 0.008), 1e-9);
}

TEST(SensorLag, ShorterThanAnyStepIsNoLag) {
  PlantModel model = bare_mass();
  model.effects.sensor_lag = SensorLag{.time = 1e-9, .delay = 1e-9};
  const auto reading = read_along(model, 300, [](double t) { return 1e-3 * std::sin(20 * t); });
  for (int k = 1; k < 300; ++k) ASSERT_NEAR(reading[k], 1e-3 * std::sin(20 * k * 1e-3), 1e-9) << k;
}

TEST(SensorLag, OfAnOldFileHasNoDelay) {
  const PlantModel model = parse_model("[baseline]\n[effect.sensor_lag]\ntime_ms = 1.5\n", "m.toml");
  EXPECT_EQ(model.effects.sensor_lag->delay, 0.0);
  EXPECT_DOUBLE_EQ(model.effects.sensor_lag->time, 1.5e-3);
}

TEST(SensorScale, MultipliesAndOffsetIsAddedAfterIt) {
  PlantModel model = bare_mass();
  model.effects.sensor_scale = SensorScale{0.1};
  model.effects.sensor_offset = SensorOffset{0.5e-3};
  PlantState state = at_rest(model);
  state.motion.x = 2e-3;
  EXPECT_DOUBLE_EQ(displacement_reading(model, state), 2e-3 * 1.1 + 0.5e-3);
}

TEST(SensorDrift, BeginsWithItsRateAndSettles) {
  PlantModel model = bare_mass();
  model.effects.sensor_drift = SensorDrift{.rate = 2e-6, .settles = 5.0};
  const auto reading = read_along(model, 60001, [](double) { return 0.0; });
  EXPECT_NEAR((reading[10] - reading[0]) / 0.010, 2e-6, 2e-3 * 2e-6);
  EXPECT_NEAR(reading[5000], 10e-6 * (1 - std::exp(-1.0)), 1e-11);
  EXPECT_NEAR(reading[60000], 10e-6, 1e-4 * 10e-6);
}

}  // namespace
}  // namespace biopsy::sim
