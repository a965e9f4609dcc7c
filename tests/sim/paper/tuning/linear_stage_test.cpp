// The linear stage against the plant itself, and against statics.
#include "sim/paper/tuning/linear_stage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "robot/common/config_error.hpp"
#include "sim/paper/feed_forward.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/plant.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim::tuning {
namespace {

using std::numbers::pi;

PlantModel damped() {
  PlantModel model = read_model(source_dir() / "sim/models/rehearsal.toml");
  model.baseline.tau_h = 0.3;
  model.baseline.c_s = 1.7;
  return model;
}

// A small sine on top of the voltage that holds `depth`, simulated_response to the plant.
std::complex<double> simulated_response(const PlantModel& model, double depth, double hertz) {
  const double held = paper::holding_voltage(model, depth, 0), small = 20.0, omega = 2.0 * pi * hertz;
  const int period = static_cast<int>(std::lround(1000.0 / hertz)), settle = 4000;
  PlantState state = at_rest(model);
  std::complex<double> in, out;
  for (int k = 0; k < settle + 4 * period; ++k) {
    const double u = held + small * std::cos(omega * k * kTick_s);
    if (k >= settle) {
      const std::complex<double> turn = std::polar(1.0, -omega * k * kTick_s);
      in += (u - held) * turn;
      out += displacement_reading(model, state) * 1e3 * turn;
    }
    state = step(model, state, {.voltage = u}, Seconds(kTick_s));
  }
  return out / in;
}

TEST(LinearStage, RespondsAsThePlantDoesToASmallSine) {
  const PlantModel model = smooth(damped());
  for (const double depth : {2.0, 6.0}) {
    const LinearStage linear = linearised(model, depth);
    for (const double hertz : {0.5, 2.0, 5.0, 10.0})
      EXPECT_NEAR(
          std::abs(simulated_response(model, depth, hertz) / response(linear, 2.0 * pi * hertz) - 1.0), 0.0,
          0.01)
          << depth << " mm, " << hertz << " Hz";
  }
}

// At standstill a volt moves the stage by the slope of its static curve.
TEST(LinearStage, ItsSlowestGainIsTheSlopeOfTheStaticCurve) {
  const PlantModel model = smooth(damped());
  const double apart = 1e-3;
  for (const double depth : {1.0, 4.0, 8.0}) {
    const double slope =
        2.0 * apart /
        (paper::holding_voltage(model, depth + apart, 0) - paper::holding_voltage(model, depth - apart, 0));
    EXPECT_NEAR(std::abs(response(linearised(model, depth), 1e-3)) / slope, 1.0, 1e-3);
  }
}

// Crossings of the open loop against poles of the closed one.
TEST(LinearStage, IsUnstableBeyondItsGainMargin) {
  const LinearStage stage = linearised(damped(), 3.0);
  std::vector<std::complex<double>> loop = response(stage);
  const PiGains gains;
  for (std::size_t i = 0; i < loop.size(); ++i) loop[i] *= controller(gains, frequencies()[i]);
  const double most = std::pow(10.0, margins(loop).gain_dB / 20.0);
  ASSERT_GT(most, 1.0);
  const auto scaled = [&](double by) {
    return PiGains{by * gains.proportional_V_per_mm, by * gains.integral_V_per_mm_per_tick};
  };
  EXPECT_TRUE(holds(stage, gains));
  EXPECT_TRUE(holds(stage, scaled(0.98 * most)));
  EXPECT_FALSE(holds(stage, scaled(1.02 * most)));
}

// docs/explanation/model.md: the paper's gains do not hold the bare baseline, a spring with a damping ratio
// of 0.1.
TEST(LinearStage, ThePapersGainsDoNotHoldTheBareBaseline) {
  EXPECT_FALSE(holds(linearised(PlantModel{}, 2.5), {}));
}

TEST(LinearStage, IncludesDelaysOfSensorAndAmplifier) {
  PlantModel late = damped(), slow = damped();
  late.effects.sensor_lag = SensorLag{.time = 1e-3, .delay = 20e-3};
  slow.effects.amplifier_lag = AmplifierLag{.time = 20e-3, .slew = 0.0};
  const double omega = 10.0;
  const auto phase = [&](const PlantModel& model) {
    return std::arg(response(linearised(model, 3.0), omega));
  };
  EXPECT_NEAR(phase(late) - phase(damped()), -omega * 20e-3, 1e-3);
  EXPECT_NEAR(phase(slow) - phase(damped()), -std::atan(omega * 20e-3), 5e-3);
}

TEST(LinearStage, RefusesADepthBeyondTheStroke) {
  EXPECT_FALSE(can_hold(damped(), 100.0));
  EXPECT_TRUE(can_hold(damped(), 5.0));
  EXPECT_THROW(linearised(damped(), 100.0), ConfigError);
}

}  // namespace
}  // namespace biopsy::sim::tuning
