// The supervisor's half of the interlock on a board of its own.
#include "drivers/nidaqmx/pulse_line.hpp"

#include <gtest/gtest.h>

#include "robot/common/config_error.hpp"
#include "tests/drivers/nidaqmx/fake_board_config.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::nidaqmx {
namespace {

constexpr std::int32_t kDeviceGone = -201003;

TEST(PulseLine, ChangesItsLevelWithEveryPulseAndIsLowBeforeAndAfter) {
  verifies("R-43");
  fake::Board& board = *fake_reset();
  {
    PulseLine line(laboratory());
    EXPECT_FALSE(board.supervisor_high);
    line.pulse();
    EXPECT_TRUE(board.supervisor_high);
    board.now_us += 1'000;
    line.pulse();
    EXPECT_FALSE(board.supervisor_high);
    EXPECT_EQ(board.supervisor_us, board.now_us);
    line.pulse();
  }
  EXPECT_FALSE(board.supervisor_high);
  EXPECT_EQ(board.tasks, 0);
}

TEST(PulseLine, ThatFailedOnceStaysAsItIsSoThatTheTimerRunsOut) {
  verifies("R-43");
  fake::Board& board = *fake_reset();
  PulseLine line(laboratory());
  fake_fail("DAQmxWriteDigitalScalarU32", kDeviceGone, 1);
  line.pulse();
  EXPECT_TRUE(line.failed());
  for (int n = 0; n < 3; ++n) {
    line.pulse();
    EXPECT_FALSE(board.supervisor_high);
    EXPECT_TRUE(line.failed());
  }
}

TEST(PulseLine, GoesOnAfterAWarning) {
  fake::Board& board = *fake_reset();
  PulseLine line(laboratory());
  fake_fail("DAQmxWriteDigitalScalarU32", 200015, 1);
  line.pulse();
  EXPECT_FALSE(line.failed());
  line.pulse();
  line.pulse();
  EXPECT_TRUE(board.supervisor_high);
}

// On any board, port and line; the level that an earlier process left is taken away.
TEST(PulseLine, IsTheLineThatIsWired) {
  fake::Board& board = *fake_reset();
  board.supervisor_wire = "Dev2/port1/line3";
  board.supervisor_line = 3;
  board.supervisor_high = true;
  Config config = laboratory();
  config.supervisor_pulse->port = 1, config.supervisor_pulse->line = 3;
  PulseLine line(config);
  EXPECT_FALSE(board.supervisor_high);
  line.pulse();
  EXPECT_TRUE(board.supervisor_high);
}

TEST(PulseLine, IsRefusedWhereNoneIsWiredOrTheBoardRefuses) {
  fake_reset();
  Config config = laboratory();
  config.supervisor_pulse->line = 7;
  EXPECT_THROW(PulseLine{config}, ConfigError);
  config.supervisor_pulse.reset();
  try {
    const PulseLine line(config);
    FAIL() << "there is none";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.where, "[supervisor_pulse]");
  }
}

}  // namespace
}  // namespace biopsy::nidaqmx
