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
  line.pulse();
  EXPECT_FALSE(board.supervisor_high);
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
