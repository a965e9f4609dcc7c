// The contract of every needle stage: the simulated one, and the NI-DAQmx driver on the fake board.
// docs/how-to/commission-a-stage.md: what this cannot prove.
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <string>

#include "sim/simulated_stage.hpp"
#include "tests/drivers/contract/driven_stage.hpp"
#include "tests/drivers/nidaqmx/fake_board_config.hpp"

namespace biopsy {
namespace {

struct Device {
  std::string name;
  std::function<std::unique_ptr<drivers::NeedleStage>()> make;
};

std::unique_ptr<drivers::NeedleStage> simulated() {
  sim::PlantModel model;
  model.effects.sensor_noise = sim::SensorNoise{.std = 10e-6};
  return std::make_unique<sim::SimulatedStage>(model, 1);
}

std::unique_ptr<drivers::NeedleStage> on_the_board() {
  fake_reset();
  return std::make_unique<nidaqmx::NidaqmxStage>(nidaqmx::laboratory(), fake_now_us);
}

class StageContract : public testing::TestWithParam<Device> {
 protected:
  std::unique_ptr<drivers::NeedleStage> stage_ = GetParam().make();
};

INSTANTIATE_TEST_SUITE_P(Devices, StageContract,
                         testing::Values(Device{"sim", simulated}, Device{"nidaqmx", on_the_board}),
                         [](const auto& device) { return device.param.name; });

constexpr std::int32_t kNear_um = 60;       // six times the laser's noise
constexpr std::int32_t kNear_mV = 30'000;   // a third of what counts as zero volts
constexpr std::int32_t kNear_nA = 200'000;  // a fifth of the arc detector's margin

TEST_P(StageContract, RestsAtZeroBeforeAnythingIsWritten) {
  const drivers::SensorReading reading = stage_->read();
  EXPECT_TRUE(reading.laser_valid);
  EXPECT_NEAR(reading.depth_um, 0, kNear_um);
  EXPECT_NEAR(reading.monitor_mV, 0, kNear_mV);
  EXPECT_NEAR(reading.current_nA, 0, kNear_nA);
}

TEST_P(StageContract, TimeRisesByATickFromWriteToWriteAndNotWithoutOne) {
  DrivenStage driven(*stage_);
  std::int64_t before_us = stage_->read().time_us;
  for (int k = 0; k < 100; ++k) {
    driven.tick(1'000'000);
    const std::int64_t now_us = stage_->read().time_us;
    EXPECT_EQ(now_us - before_us, 1'000);
    before_us = now_us;
  }
}

TEST_P(StageContract, MonitorFollowsTheCommandInSizeAndSign) {
  DrivenStage driven(*stage_);
  for (const std::int32_t level_mV : {500'000, 3'000'000, 7'900'000, -7'900'000, -500'000}) {
    driven.hold(level_mV, 30);
    ASSERT_EQ(driven.command_mV(), level_mV);
    EXPECT_NEAR(stage_->read().monitor_mV, level_mV, kNear_mV + std::abs(level_mV) / 100);
  }
}

TEST_P(StageContract, DepthRisesWithVoltageOfEitherSign) {
  for (const int sign : {1, -1}) {
    stage_.reset();
    stage_ = GetParam().make();
    DrivenStage driven(*stage_);
    const std::int32_t at_3kV_um = driven.hold(sign * 3'000'000, 1'000).depth_um;
    const std::int32_t at_6kV_um = driven.hold(sign * 6'000'000, 1'000).depth_um;
    EXPECT_GT(at_3kV_um, 2 * kNear_um) << sign;
    EXPECT_GT(at_6kV_um, at_3kV_um + 1'000) << sign;
    EXPECT_LT(at_6kV_um, 15'000) << "micrometres, and no farther than the stroke";
  }
}

TEST_P(StageContract, OffIsZeroVoltsAndTheNeedleReturns) {
  DrivenStage driven(*stage_);
  driven.hold(6'000'000, 500);
  driven.tick(6'000'000, false);
  EXPECT_EQ(driven.command_mV(), 0);
  EXPECT_NEAR(stage_->read().monitor_mV, 0, kNear_mV) << "in the very next reading";
  for (int k = 0; k < 2'000; ++k) stage_->write(safety::GatedVoltage::off());
  EXPECT_NEAR(stage_->read().depth_um, 0, 1'000);
}

TEST_P(StageContract, CurrentHasTheSignOfTheVoltageChange) {
  DrivenStage driven(*stage_);
  driven.hold(400'000, 2);
  EXPECT_GT(stage_->read().current_nA, 0);
  driven.hold(4'000'000, 50);
  EXPECT_NEAR(stage_->read().current_nA, 0, kNear_nA) << "at constant voltage";
  driven.tick(3'600'000);
  EXPECT_LT(stage_->read().current_nA, 0);
}

TEST_P(StageContract, NoRequestExceedsTheLimitOfTheBuild) {
  DrivenStage driven(*stage_);
  for (const std::int32_t wanted_mV :
       {std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()}) {
    driven.hold(wanted_mV, 50);
    EXPECT_EQ(std::abs(driven.command_mV()), 8'000'000);
    EXPECT_LE(std::abs(stage_->read().monitor_mV), 8'100'000);
  }
}

TEST_P(StageContract, NoiseOfTheLaserShowsInItsCode) {
  DrivenStage driven(*stage_);
  std::set<std::int32_t> codes;
  for (int k = 0; k < 20; ++k) codes.insert(driven.tick(0).laser_code);
  EXPECT_GT(codes.size(), 5U) << "a code that never changes counts as a frozen sensor";
}

TEST_P(StageContract, ReadingTwiceMovesNothing) {
  DrivenStage driven(*stage_);
  driven.hold(5'000'000, 200);
  const drivers::SensorReading first = stage_->read(), second = stage_->read();
  EXPECT_EQ(first.time_us, second.time_us);
  EXPECT_NEAR(first.depth_um, second.depth_um, 2 * kNear_um);
  EXPECT_NEAR(first.monitor_mV, second.monitor_mV, 2 * kNear_mV);
}

}  // namespace
}  // namespace biopsy
