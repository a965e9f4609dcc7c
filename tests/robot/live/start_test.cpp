// How the supervisor starts: what it asks of itself, and under what number.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "drivers/digital_io/shared_io.hpp"
#include "robot/common/config_error.hpp"
#include "robot/live/monotonic_session_id.hpp"
#include "robot/live/supervisor_loop.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::live {
namespace {

using namespace safety;

// A supervisor alone on a bus of its own, for some ticks.
Mode mode_after_start(SelfTest self) {
  const ScratchFolder folder;
  const transport::Participant bus({83, "", 1});
  digital_io::create_shared_io(folder.path());
  digital_io::SupervisorIo lines(folder.path());
  const digital_io::IoReader panel(folder.path());
  const FilesTag files;
  SupervisorLoop loop(bus, lines, panel, files, 1, 1, self);
  for (int n = 0; n < 20; ++n) loop.turn();
  return loop.mode();
}

TEST(SelfTest, ThatFailedLocksTheSupervisor) {
  EXPECT_EQ(mode_after_start(SelfTest::Failed), Mode::Lock);
  EXPECT_EQ(mode_after_start(SelfTest::Passed), Mode::Boot) << "nobody measures, so 0 V is not known";
}

TEST(MonotonicSessionId, RisesFromStartToStartWhateverTheWallClockSays) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "session";
  const std::uint32_t first = monotonic_session_id(file);
  EXPECT_GT(first, 1'700'000'000U);
  EXPECT_EQ(monotonic_session_id(file), first + 1) << "two starts within a second";
  std::ofstream(file) << "4000000000\n";  // a clock that was set back since
  EXPECT_EQ(monotonic_session_id(file), 4'000'000'001U);
  EXPECT_EQ(monotonic_session_id(file), 4'000'000'002U);
}

TEST(MonotonicSessionId, IsRefusedWhereTheLastOneIsNotKnown) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "session";
  for (const char* text : {"", "soon", "-1", "4294967295", "99999999999999999999"}) {
    std::ofstream(file) << text;
    EXPECT_THROW(monotonic_session_id(file), ConfigError) << text;
  }
  EXPECT_THROW(monotonic_session_id(folder.path() / "nowhere" / "session"), ConfigError);
}

}  // namespace
}  // namespace biopsy::live
