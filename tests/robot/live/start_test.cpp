// How the supervisor starts: what it asks of itself.
#include <gtest/gtest.h>

#include "drivers/digital_io/shared_io.hpp"
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
  SupervisorLoop loop(bus, lines, panel, files, 1, 1, self, false);
  for (int n = 0; n < 20; ++n) loop.turn();
  return loop.mode();
}

TEST(SelfTest, ThatFailedLocksTheSupervisor) {
  EXPECT_EQ(mode_after_start(SelfTest::Failed), Mode::Lock);
  EXPECT_EQ(mode_after_start(SelfTest::Passed), Mode::Boot) << "nobody measures, so 0 V is not known";
}

}  // namespace
}  // namespace biopsy::live
