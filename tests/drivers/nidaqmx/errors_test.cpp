// Errors in the tick: the reading, the converter and the pulse to the interlock.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "drivers/nidaqmx/pulse_line.hpp"
#include "tests/drivers/contract/driven_stage.hpp"
#include "tests/drivers/nidaqmx/fake_board_config.hpp"
#include "tests/robot/live/realtime/counting_allocator.hpp"

namespace biopsy::nidaqmx {
namespace {

class NidaqmxErrors : public testing::Test {
 protected:
  // 2 kV standing.
  void SetUp() override { driven_.hold(2'000'000, 50); }

  bool is_fed(int ticks = 1) {
    const std::uint32_t before = board_.lines & 1U;
    bool changed = false;
    for (int k = 0; k < ticks; ++k) {
      driven_.tick(2'000'000);
      changed = changed || (board_.lines & 1U) != before;
    }
    return changed;
  }

  fake::Board& board_ = *fake_reset();
  NidaqmxStage stage_{laboratory(), fake_now_us};
  DrivenStage driven_{stage_};
};

TEST(NidaqmxTick, TakesNoMemoryNotEvenForErrors) {
  for (const Status status : {0, -200284, -201003, -200088}) {
    fake_reset();
    NidaqmxStage stage(laboratory(), fake_now_us);
    PulseLine line(laboratory());
    DrivenStage driven(stage);
    fake_fail("DAQmxReadAnalogF64", status, -1);
    const realtime::AllocationCount count;
    driven.hold(3'000'000, 100);
    for (int n = 0; n < 100; ++n) line.pulse();
    EXPECT_EQ(count.so_far(), 0U) << status;
    EXPECT_EQ(stage.last_error().count > 0, status != 0);
  }
}

TEST_F(NidaqmxErrors, HealthyTicksFeedTheInterlock) {
  EXPECT_TRUE(is_fed());
  EXPECT_TRUE(is_fed());
  EXPECT_EQ(board_.output_V, 2.0);
  EXPECT_EQ(board_.lines & 0b10U, 0b10U) << "enabled";
}

TEST(NidaqmxBrake, IsALineOfTheBoardThatIsHighWhileTheNeedleIsLockedAndTheDriveEnabled) {
  fake::Board& board = *fake_reset();
  Config config = laboratory();
  config.interlock.brake_line = 2;
  NidaqmxStage stage(config, fake_now_us);
  DrivenStage driven(stage);
  EXPECT_TRUE(driven.tick(2'000'000).brake_fitted);
  EXPECT_EQ(board.lines & 0b100U, 0U);
  driven.tick(2'000'000, true, true);
  EXPECT_EQ(board.lines & 0b100U, 0b100U);
  EXPECT_TRUE(driven.tick(2'000'000, true, false).brake_on);
  EXPECT_EQ(board.lines & 0b100U, 0U);
  driven.tick(0, false, true);
  EXPECT_EQ(board.lines & 0b110U, 0U) << "neither enabled nor locked";
  driven.tick(0, true, true);
  fake_fail("DAQmxWriteAnalogScalarF64", -200088, 1);
  driven.tick(0, true, true);
  EXPECT_EQ(board.lines & 0b110U, 0U) << "stopped for good: it lets go";
}

TEST(NidaqmxBrake, AStageWithoutTheLineHasNone) {
  fake_reset();
  NidaqmxStage stage(laboratory(), fake_now_us);
  DrivenStage driven(stage);
  EXPECT_FALSE(driven.tick(2'000'000).brake_fitted);
}

TEST_F(NidaqmxErrors, ReadingThatTimesOutIsNotRenewedAndTheNextOneIs) {
  for (const Status late : {-200284, -200279, -200278}) {
    const drivers::SensorReading before = stage_.read();
    driven_.tick(2'000'000);
    fake_fail("DAQmxReadAnalogF64", late, 1);
    const drivers::SensorReading missed = stage_.read();
    EXPECT_FALSE(missed.laser_valid);
    EXPECT_EQ(missed.laser_code, before.laser_code) << "repeats the last";
    EXPECT_GT(missed.time_us, before.time_us) << "the clock is sound";
    EXPECT_EQ(stage_.last_error().status, late);
    EXPECT_TRUE(stage_.read().laser_valid);
    EXPECT_FALSE(stage_.stopped());
  }
}

TEST_F(NidaqmxErrors, TickWithoutReadingDoesNotFeedTheInterlock) {
  fake_fail("DAQmxReadAnalogF64", -200284, -1);
  EXPECT_FALSE(is_fed(5));
  fake_fail("DAQmxReadAnalogF64", 0, 0);
  EXPECT_TRUE(is_fed());
}

TEST_F(NidaqmxErrors, UnreadablePanelCountsAsAMissedTick) {
  EXPECT_TRUE(stage_.panel().estop_a_closed && stage_.panel().estop_b_closed);
  fake_fail("DAQmxReadDigitalScalarU32", -200284, 1);
  EXPECT_FALSE(stage_.read().laser_valid);
  board_.contacts = 0b0101;
  EXPECT_TRUE(stage_.read().laser_valid);
  EXPECT_TRUE(stage_.panel().arm && stage_.panel().estop_a_closed);
  EXPECT_FALSE(stage_.panel().reset || stage_.panel().estop_b_closed);
}

TEST_F(NidaqmxErrors, BoardThatIsGoneStopsForGood) {
  for (const Status gone : {-201003, -200324, -50405, -50400}) {
    SCOPED_TRACE(gone);
    fake::Board& board = *fake_reset();
    NidaqmxStage stage(laboratory(), fake_now_us);
    DrivenStage driven(stage);
    driven.hold(2'000'000, 50);
    const std::int64_t last_us = stage.read().time_us;
    fake_fail("DAQmxReadAnalogF64", gone, 1);
    driven.tick(2'000'000);
    EXPECT_TRUE(stage.stopped());
    EXPECT_EQ(error_kind(stage.last_error().status), ErrorKind::Gone);
    EXPECT_EQ(board.output_V, 0.0) << "in the same tick, whatever the gate says";
    EXPECT_EQ(board.lines & 0b10U, 0U) << "not enabled";
    const std::uint32_t pulse = board.lines & 1U;
    for (int k = 0; k < 50; ++k) {
      const Measurement measured = driven.tick(2'000'000);
      EXPECT_EQ(measured.time_us, last_us) << "a clock that stands still is a C0 for the supervisor";
      EXPECT_FALSE(measured.laser_valid);
      EXPECT_EQ(board.lines & 1U, pulse);
      EXPECT_EQ(board.output_V, 0.0);
    }
    EXPECT_FALSE(stage.panel().estop_a_closed || stage.panel().arm);
  }
}

TEST_F(NidaqmxErrors, InvalidTaskIsAFaultAndKeepsTheDriversText) {
  fake_fail("DAQmxReadAnalogF64", -200088, 1);
  stage_.read();
  EXPECT_TRUE(stage_.stopped());
  EXPECT_EQ(error_kind(stage_.last_error().status), ErrorKind::Fault);
  EXPECT_EQ(stage_.last_error().text.data(), std::string("the test lets DAQmxReadAnalogF64 fail"));
  EXPECT_EQ(stage_.last_error().count, 1U);
}

TEST_F(NidaqmxErrors, VoltageThatCouldNotBeWrittenStopsTheStage) {
  fake_fail("DAQmxWriteAnalogScalarF64", -200284, 1);
  EXPECT_FALSE(is_fed()) << "the converter still holds 2 V: the interlock must open";
  EXPECT_TRUE(stage_.stopped());
  EXPECT_EQ(board_.lines & 0b10U, 0U);
  driven_.tick(2'000'000);
  EXPECT_EQ(board_.output_V, 0.0) << "tried again until it works";
}

TEST_F(NidaqmxErrors, ConverterThatCannotBeWrittenIsSwitchedOffByTheInterlock) {
  fake_fail("DAQmxWriteAnalogScalarF64", -50405, -1);
  for (int k = 0; k < 10; ++k) driven_.tick(2'000'000);
  EXPECT_EQ(board_.output_V, 2.0) << "holds";
  const bool closed = board_.now_us - board_.pulse_us < 20'000 && (board_.lines & 0b10U) != 0;
  EXPECT_FALSE(closed);
}

TEST_F(NidaqmxErrors, PulseThatCannotBeWrittenStopsTheStage) {
  fake_fail("DAQmxWriteDigitalScalarU32", -200284, 1);
  driven_.tick(2'000'000);
  EXPECT_TRUE(stage_.stopped());
}

TEST_F(NidaqmxErrors, StuckConverterRepeatsItsCodeForTheSupervisorToSee) {
  stage_.read();
  board_.laser_stuck = true;
  const std::int32_t code = stage_.read().laser_code;
  for (int k = 0; k < 30; ++k) EXPECT_EQ(driven_.tick(2'000'000).laser_code, code);
}

TEST_F(NidaqmxErrors, LaserOutOfItsRangeIsNotValid) {
  board_.laser_zero_V = 9.95;
  EXPECT_FALSE(stage_.read().laser_valid);
  board_.laser_zero_V = -5.0;
  EXPECT_FALSE(stage_.read().laser_valid);
}

TEST_F(NidaqmxErrors, VoltsThatAreNoNumbersAreNoReading) {
  board_.laser_zero_V = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(stage_.read().laser_valid);
  EXPECT_FALSE(is_fed());
}

TEST_F(NidaqmxErrors, ConfiguredLimitHoldsBelowTheGates) {
  Config config = laboratory();
  config.command.highest_kV = 1.0;
  fake::Board& board = *fake_reset();
  NidaqmxStage stage(config, fake_now_us);
  DrivenStage driven(stage);
  driven.hold(-3'000'000, 50);
  EXPECT_EQ(board.output_V, -1.0);
}

TEST_F(NidaqmxErrors, CommissioningCanStopTheFeedAndTheInterlockOpens) {
  stage_.feed_interlock(false);
  driven_.hold(2'000'000, 30);
  EXPECT_EQ(board_.output_V, 2.0) << "the driver itself goes on";
  EXPECT_NEAR(stage_.read().monitor_mV, 0, 30'000) << "but the amplifier is off";
  stage_.feed_interlock(true);
  driven_.hold(2'000'000, 5);
  EXPECT_NEAR(stage_.read().monitor_mV, 2'000'000, 30'000);
}

}  // namespace
}  // namespace biopsy::nidaqmx
