// Which terminal of the board is which input and output: every one at a place or with a scale of its own, so
// that one that is read from its neighbour shows. Expected values are the configuration's, by hand.
#include <gtest/gtest.h>

#include "robot/common/config_error.hpp"
#include "tests/drivers/contract/driven_stage.hpp"
#include "tests/drivers/nidaqmx/fake_board_config.hpp"

namespace biopsy::nidaqmx {
namespace {

using drivers::Panel;

constexpr std::int32_t kNear_um = 100, kNear_mV = 20'000;  // ten times the board's noise

struct NidaqmxWiring : testing::Test {
  fake::Board& board = *fake_reset();
  Config config = laboratory();
};

TEST_F(NidaqmxWiring, EachContactOfThePanelHasItsOwnLine) {
  config.panel = PanelInputs{.port = 0, .arm_line = 6, .reset_line = 4, .estop_a_line = 7, .estop_b_line = 5};
  NidaqmxStage stage(config, fake_now_us);
  const std::pair<std::uint32_t, bool Panel::*> contacts[] = {
      {6, &Panel::arm}, {4, &Panel::reset}, {7, &Panel::estop_a_closed}, {5, &Panel::estop_b_closed}};
  for (const auto& [line, closed] : contacts) {
    board.contacts = 1U << line;
    stage.read();
    EXPECT_TRUE(stage.panel().read);
    for (const auto& [other, contact] : contacts)
      EXPECT_EQ(stage.panel().*contact, other == line) << "line " << line << " in contact of line " << other;
  }
}

TEST_F(NidaqmxWiring, WithoutAPanelThereIsNoneAndTheRestIsRead) {
  config.panel.reset();
  NidaqmxStage stage(config, fake_now_us);
  EXPECT_TRUE(stage.read().laser_valid);
  EXPECT_FALSE(stage.panel().read || stage.panel().arm || stage.panel().estop_a_closed);
}

TEST_F(NidaqmxWiring, TheRelaysContactIsReadBehindTheSecondLaserOrInItsPlace) {
  for (const bool second : {true, false})
    for (const bool wired : {true, false}) {
      fake::Board& fresh = *fake_reset();
      Config other = laboratory();
      if (!second) other.second_laser.reset();
      if (!wired) other.relay_contact.reset();
      NidaqmxStage stage(other, fake_now_us);
      for (const bool closed : {true, false}) {
        fresh.has_interlock = !closed;  // one that nothing fed is open
        stage.read();
        EXPECT_EQ(stage.panel().relay_closed, closed && wired) << second << wired;
      }
    }
}

TEST_F(NidaqmxWiring, EachLaserAndMonitorHasItsOwnScale) {
  config.laser.zero_V = 1.0, config.laser.mm_per_V = 4.0;
  config.second_laser->zero_V = 1.25, config.second_laser->mm_per_V = 3.0;
  config.voltage.per_V = 2.0;
  config.current.per_V = 8.0;
  board.monitor_offset_V = 0.5;
  NidaqmxStage stage(config, fake_now_us);
  board.plant.charge = 8e-6;  // in a millisecond: 8 mA, which the board shows as 2 V
  const drivers::SensorReading reading = stage.read();  // both lasers show 1.5 V at rest
  EXPECT_NEAR(reading.depth_um, 2'000, kNear_um);
  EXPECT_NEAR(reading.depth_b_um, 750, kNear_um);
  EXPECT_NEAR(reading.monitor_mV, 1'000'000, kNear_mV);
  EXPECT_NEAR(reading.current_nA, 16'000'000, 200'000);
  EXPECT_TRUE(reading.laser_valid && reading.laser_b_valid);
}

TEST_F(NidaqmxWiring, EachLaserHasItsOwnTerminal) {
  board.laser_stuck = true;  // the first alone
  board.laser_stuck_V = 2.5;
  config.second_laser->valid_high_V = 2.0;
  NidaqmxStage stage(config, fake_now_us);
  const drivers::SensorReading reading = stage.read();
  EXPECT_NEAR(reading.depth_um, 2'000, kNear_um);
  EXPECT_NEAR(reading.depth_b_um, 0, kNear_um);
  EXPECT_TRUE(reading.laser_valid && reading.laser_b_valid);
}

TEST_F(NidaqmxWiring, AMissedReadingShowsNeitherLaser) {
  NidaqmxStage stage(config, fake_now_us);
  EXPECT_TRUE(stage.read().laser_b_valid && stage.panel().read);
  fake_fail("DAQmxReadAnalogF64", -200284, 1);
  const drivers::SensorReading missed = stage.read();
  EXPECT_FALSE(missed.laser_valid || missed.laser_b_valid || stage.panel().read);
}

TEST_F(NidaqmxWiring, AnotherRangeHasCodesOfAnotherSize) {
  config.laser.input.low_V = -5.0, config.laser.input.high_V = 10.0;
  NidaqmxStage stage(config, fake_now_us);
  EXPECT_NEAR(stage.read().laser_code, 1.5 / 15.0 * 65'536, 250);
}

TEST_F(NidaqmxWiring, TheBrakeHasALineOfItsOwnBesideEnableAndPulse) {
  config.interlock.brake_line = 3;
  NidaqmxStage stage(config, fake_now_us);
  DrivenStage driven(stage);
  driven.hold(0, 3);
  EXPECT_EQ(board.lines & 0b1010U, 0b0010U) << "enabled, not locked";
  driven.tick(0, true, true);
  EXPECT_EQ(board.lines & 0b1010U, 0b1010U);
  const std::uint32_t pulse = board.lines & 1U;
  driven.tick(0, true, true);
  EXPECT_NE(board.lines & 1U, pulse);
  driven.tick(0, false, true);
  EXPECT_EQ(board.lines & 0b1010U, 0U) << "let go where high voltage is off";
}

TEST_F(NidaqmxWiring, AVoltageThatWasNotWrittenIsSaidToBeNone) {
  NidaqmxStage stage(config, fake_now_us);
  DrivenStage driven(stage);
  driven.hold(2'000'000, 30);
  fake_fail("DAQmxWriteAnalogScalarF64", -200284, 1);
  driven.tick(2'000'000);
  EXPECT_EQ(driven.command_mV(), 0);
}

TEST_F(NidaqmxWiring, ABoardOfAnySerialNumberButItsOwnIsRefused) {
  for (const std::uint32_t serial : {board.serial - 1, board.serial + 1}) {
    config.serial = serial;
    EXPECT_THROW(NidaqmxStage(config, fake_now_us), ConfigError);
  }
  config.serial = board.serial;
  const NidaqmxStage right(config, fake_now_us);
  EXPECT_EQ(right.product(), "USB-6211");
  EXPECT_EQ(right.serial(), board.serial);
}

// The driver's warnings are positive.
TEST_F(NidaqmxWiring, AWarningStopsNothing) {
  NidaqmxStage stage(config, fake_now_us);
  DrivenStage driven(stage);
  fake_fail("DAQmxWriteAnalogScalarF64", 200015, 1);
  driven.hold(1'000'000, 3);
  EXPECT_FALSE(stage.stopped());
  EXPECT_EQ(stage.last_error().count, 0U);
}

TEST_F(NidaqmxWiring, EachLaserIsValidInItsOwnRange) {
  for (const bool first : {true, false}) {
    Config other = laboratory();
    (first ? other.laser : *other.second_laser).valid_low_V = 2.0;
    fake_reset();
    NidaqmxStage stage(other, fake_now_us);
    const drivers::SensorReading reading = stage.read();
    EXPECT_EQ(reading.laser_valid, !first);
    EXPECT_EQ(reading.laser_b_valid, first);
  }
}

TEST_F(NidaqmxWiring, TheCommandIsDividedByTheAmplifiersGainAndEndsAtItsLimit) {
  config.command.kV_per_V = 2.0, config.command.highest_kV = 3.0;
  NidaqmxStage stage(config, fake_now_us);
  DrivenStage driven(stage);
  driven.hold(2'000'000, 30);
  EXPECT_NEAR(board.output_V, 1.0, 1e-6);
  EXPECT_EQ(driven.command_mV(), 2'000'000);
  driven.hold(5'000'000, 30);
  EXPECT_NEAR(board.output_V, 1.5, 1e-6);
  EXPECT_EQ(driven.command_mV(), 3'000'000) << "what it wrote, not what it was asked for";
}

}  // namespace
}  // namespace biopsy::nidaqmx
