// The simulated stage behind the port of the hardware.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/simulated_stage.hpp"
#include "tests/sim/effects/staged_model.hpp"

namespace biopsy::sim {
namespace {

// A gate with a permit for any voltage: only a gate can make a voltage.
struct OpenGate {
  safety::GateState state;
  Permit permit;
  DriveRequest request;
  std::int64_t now_us = 0;

  safety::GatedVoltage operator()(std::int32_t mV) {
    if (permit.seq == 0) pass(0, false);  // the first permit of a session is off
    return pass(mV, true);
  }

 private:
  safety::GatedVoltage pass(std::int32_t mV, bool enable) {
    permit.session = permit.epoch = 1;
    ++permit.seq;
    permit.ttl_us = 5000;
    permit.hv_enable = enable;
    permit.mode = enable ? Mode::Active : Mode::Safe;
    permit.stop = StopCategory::None;
    permit.v_max_mV = enable ? 8'000'000 : 0;
    permit.slew_up_mV_per_tick = enable ? 400'000 : 0;
    ++request.seq;
    request.wanted_mV = mV;
    now_us += 1000;
    const auto result = safety::gate(state, &request, &permit, now_us, 1);
    state = result.state;
    return result.voltage;
  }
};

TEST(SimulatedStage, ReadsRestBeforeAnythingIsWritten) {
  PlantModel model;
  SimulatedStage stage(model, 1);
  const drivers::SensorReading reading = stage.read();
  EXPECT_EQ(reading.time_us, 0);
  EXPECT_EQ(reading.depth_um, 0);
  EXPECT_TRUE(reading.laser_valid);
  EXPECT_EQ(reading.monitor_mV, 0);
  EXPECT_LT(std::abs(reading.current_nA), 150);  // seven standard deviations of its noise
}

PlantModel braked(const Brake& brake) {
  PlantModel model;
  model.effects.coulomb_friction.emplace().force = 0.02;
  model.brake = brake;
  return model;
}

// Newton's and Hooke's laws by hand: a clamped plate carries its weight after the pull is gone, and yields by
// that over the clamp's stiffness.
TEST(SimulatedStage, ALockedNeedleYieldsByTheLoadOverTheStiffnessOfTheClamp) {
  constexpr double kStiffness = 20e3;
  SimulatedStage stage(braked({.holding_N = 5.0, .stiffness = kStiffness, .damping = 5.0}), 1);
  for (int k = 0; k < 3000; ++k) stage.put_out(k % 500 < 250 ? 4500.0 : -4500.0);
  const double lifted = stage.truth().motion.x;
  ASSERT_GT(lifted, 1e-3);
  for (int k = 0; k < 40'000; ++k) stage.put_out(0.0, true);
  const PlantModel& model = stage.model();
  const double load_N =
      model.mass_A() * model.baseline.g -
      std::max(0.0, model.mass_A() * model.baseline.g - model.baseline.k * stage.truth().motion.x);
  EXPECT_NEAR(lifted - stage.truth().motion.x, load_N / kStiffness, 0.02 / kStiffness + 2e-6);
  EXPECT_EQ(stage.truth().motion.v, 0.0);
  for (int k = 0; k < 3000; ++k) stage.put_out(0.0, false);
  EXPECT_LT(stage.truth().motion.x, 0.3e-3) << "let go, it falls back";
}

TEST(SimulatedStage, ABrakeThatIsTooWeakSlipsAndOneThatIsLateGripsLater) {
  for (const bool late : {false, true}) {
    const Brake brake = late ? Brake{.holding_N = 5.0, .stiffness = 20e3, .damping = 5.0, .engage_s = 0.03}
                             : Brake{.holding_N = 0.1, .stiffness = 20e3, .damping = 5.0};
    SimulatedStage stage(braked(brake), 1);
    for (int k = 0; k < 3000; ++k) stage.put_out(k % 500 < 250 ? 4500.0 : -4500.0);
    const double lifted = stage.truth().motion.x;
    for (int k = 0; k < 3000; ++k) stage.put_out(0.0, true);
    EXPECT_LT(stage.truth().motion.x, lifted - 0.2e-3);
    if (late) {
      EXPECT_GT(stage.truth().motion.x, 0.3e-3);
    }
  }
}

TEST(SimulatedStage, WithoutABrakeSaysSoAndIsNotLocked) {
  SimulatedStage plain(PlantModel{}, 1), other(PlantModel{}, 1);
  EXPECT_FALSE(plain.read().brake_fitted);
  EXPECT_TRUE(SimulatedStage(braked({.holding_N = 1.0, .stiffness = 1e3}), 1).read().brake_fitted);
  for (int k = 0; k < 500; ++k) plain.put_out(3000.0, true), other.put_out(3000.0, false);
  EXPECT_EQ(plain.truth().motion.x, other.truth().motion.x);
}

TEST(SimulatedStage, OneMillisecondPassesWithEachWriteAndNoneWithARead) {
  SimulatedStage stage(PlantModel{}, 1);
  for (int k = 1; k <= 5; ++k) {
    stage.write(safety::GatedVoltage::off());
    EXPECT_EQ(stage.read().time_us, 1000 * k);
    EXPECT_EQ(stage.read().time_us, 1000 * k);
  }
  EXPECT_EQ(stage.now_us(), 5000);
}

TEST(SimulatedStage, MovesAsThePlantDoesUnderTheGatesVoltage) {
  const PlantModel model = rehearsal_with_tissue();
  SimulatedStage stage(model, 5);
  OpenGate gate;
  PlantModel seeded = model;
  seeded.noise_seed = 5;
  PlantState state = at_rest(seeded);
  for (int k = 0; k < 3000; ++k) {
    const double amplitude = std::min(3000.0, 2.0 * k);
    const auto voltage = gate(static_cast<std::int32_t>(1e3 * amplitude));
    ASSERT_EQ(voltage.mV(), static_cast<std::int32_t>(1e3 * amplitude)) << k;
    stage.write(voltage);
    state = step(seeded, state, {.voltage = voltage.mV() * 1e-3}, Seconds(1e-3));
    ASSERT_EQ(stage.truth().motion.x, state.motion.x);
    const auto reading = stage.read();
    ASSERT_NEAR(reading.depth_um, displacement_reading(seeded, state) * 1e6, 0.5 + 1e-6);
    ASSERT_NEAR(reading.monitor_mV, voltage.mV(), 0.006 * voltage.mV() + 1) << k;
  }
  EXPECT_GT(stage.truth().motion.x, 1e-3);
}

TEST(SimulatedStage, DepthIsTheLasersCodeTimesItsStep) {
  PlantModel model;
  model.effects.sensor_offset = SensorOffset{1.2346e-3};
  SimulatedStage stage(model, 1, {.laser_code_um = 5});
  const auto reading = stage.read();
  EXPECT_EQ(reading.laser_code, 247);
  EXPECT_EQ(reading.depth_um, 1235);
}

TEST(SimulatedStage, MonitorsHaveTheirOwnNoise) {
  SimulatedStage clean(PlantModel{}, 1, {.monitor_noise = 0.0, .current_noise_A = 0.0});
  SimulatedStage noisy(PlantModel{}, 1);
  OpenGate gate;
  double sum = 0.0, squares = 0.0;
  constexpr int kCount = 4000;
  for (int k = 0; k < kCount; ++k) {
    const auto voltage = gate(std::min(400'000 * (k + 1), 2'000'000));
    clean.write(voltage);
    noisy.write(voltage);
    ASSERT_EQ(clean.read().monitor_mV, voltage.mV());
    ASSERT_EQ(clean.read().current_nA, std::lround(clean.truth().charge / 1e-3 * 1e9));
    const double error = (noisy.read().monitor_mV - voltage.mV()) / static_cast<double>(voltage.mV());
    sum += error / kCount;
    squares += error * error / kCount;
  }
  EXPECT_NEAR(sum, 0.0, 4 * 0.001 / std::sqrt(kCount));
  EXPECT_NEAR(std::sqrt(squares), 0.001, 0.05 * 0.001);
}

TEST(SimulatedStage, IsDeterministicForASeed) {
  const auto readings = [](std::uint64_t seed) {
    SimulatedStage stage(rehearsal_with_tissue(), seed);
    std::vector<std::int32_t> out;
    for (int k = 0; k < 200; ++k) {
      stage.write(safety::GatedVoltage::off());
      out.push_back(stage.read().depth_um);
      out.push_back(stage.read().current_nA);
    }
    return out;
  };
  EXPECT_EQ(readings(3), readings(3));
  EXPECT_NE(readings(3), readings(4));
}

}  // namespace
}  // namespace biopsy::sim
