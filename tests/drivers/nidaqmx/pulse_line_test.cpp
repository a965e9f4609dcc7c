// The supervisor's half of the interlock on a board of its own.
#include "drivers/nidaqmx/pulse_line.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "tests/drivers/nidaqmx/stage_in_hand.hpp"
#include "tests/robot/live/realtime/counting_allocator.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/source_dir.hpp"

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

TEST(PulseLine, ThatFailedOnceIsNotAskedAgainSoThatTheTimerRunsOut) {
  verifies("R-43");
  fake::Board& board = *fake_reset();
  PulseLine line(laboratory());
  fake_fail("DAQmxWriteDigitalScalarU32", kDeviceGone, 1);
  line.pulse();
  EXPECT_TRUE(line.failed());
  line.pulse();
  EXPECT_FALSE(board.supervisor_high);
}

TEST(PulseLine, TakesNoMemoryInATick) {
  fake_reset();
  PulseLine line(laboratory());
  const realtime::AllocationCount count;
  for (int n = 0; n < 100; ++n) line.pulse();
  EXPECT_EQ(count.so_far(), 0U);
}

TEST(PulseLine, IsRefusedWhereNoneIsWiredOrTheBoardDoesNotGiveIt) {
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

TEST(PulseLine, MayNotBeOnTheStagesBoard) {
  std::string sample = read_file(source_dir() / "drivers/nidaqmx/usb6211.toml");
  EXPECT_NO_THROW(parse_config(sample, "test"));
  sample.replace(sample.find("\"Dev2\""), 6, "\"Dev1\"");
  try {
    parse_config(sample, "test");
    FAIL() << "one board feeds both halves";
  } catch (const ConfigError& error) {
    EXPECT_NE(error.what_is_wrong.find("the stage's board"), std::string::npos) << error.what_is_wrong;
  }
}

}  // namespace
}  // namespace biopsy::nidaqmx
