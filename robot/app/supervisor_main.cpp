// biopsy-supervisor RUN_FOLDER: decides the permit.
#include "robot/live/live_process.hpp"
#include "robot/live/rising_number.hpp"
#include "robot/live/self_test.hpp"
#include "robot/live/supervisor_loop.hpp"
#include "robot/realtime/tick_clock.hpp"

namespace {

using namespace biopsy;

void supervise(const std::filesystem::path& run_folder) {
  live::LiveProcess process(run_folder, keys::Role::Supervisor);
  lines::SupervisorLines lines(process.settings().lines);
  const lines::LinesReader panel(process.settings().lines);
  live::SupervisorLoop loop(process.bus(), lines, panel, process.config_tag(),
                            live::rising_number(run_folder / "session"), live::self_test());
  process.start_ticking();
  while (!process.stop_asked()) {
    loop.turn();
    process.stroke_watchdog(realtime::monotonic_ns() / 1000);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return live::live_main(argc, argv, "biopsy-supervisor", supervise);
}
