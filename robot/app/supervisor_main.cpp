// biopsy-supervisor RUN_FOLDER: decides the permit.
#include <chrono>

#include "robot/live/live_process.hpp"
#include "robot/live/supervisor_loop.hpp"
#include "robot/realtime/tick_clock.hpp"

namespace {

using namespace biopsy;

// Larger at every start, as the gate wants it.
std::uint32_t new_session() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::seconds>(since_1970).count());
}

void supervise(const std::filesystem::path& run_folder) {
  live::LiveProcess process(run_folder, keys::Role::Supervisor);
  lines::SupervisorLines lines(process.settings().lines);
  const lines::LinesReader panel(process.settings().lines);
  live::SupervisorLoop loop(process.bus(), lines, panel, process.config_tag(), new_session());
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
