// biopsy-controller RUN_FOLDER: runs the plan and requests voltages.
#include "robot/live/controller_loop.hpp"
#include "robot/live/live_process.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace {

using namespace biopsy;

constexpr std::chrono::milliseconds kTimeout{10};  // for a measurement, before the other topics are read

void control_stage(const std::filesystem::path& run_folder) {
  live::LiveProcess process(run_folder, security::Role::Controller);
  live::ControllerLoop loop(process.bus(), process.config_tag());
  process.start_ticking();
  while (!process.stop_asked()) {
    loop.turn(kTimeout);
    process.after_tick(realtime::monotonic_ns() / 1000, loop.heartbeat().health());
  }
}

}  // namespace

int main(int argc, char** argv) {
  return live::live_main(argc, argv, "controller", control_stage);
}
