// biopsy-supervisor RUN_FOLDER: decides the permit.
#include <optional>

#include "drivers/nidaqmx/pulse_line.hpp"
#include "robot/cycle/self_test.hpp"
#include "robot/live/live_process.hpp"
#include "robot/live/monotonic_session_id.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/live/supervisor_loop.hpp"

namespace {

using namespace biopsy;

// The supervisor's half of the interlock: the simulated digital I/O, and a hardware line where there is one.
class Interlock final : public drivers::PulseOutput {
 public:
  explicit Interlock(const live::LiveSettings& settings) : lines_(settings.lines) {
    if (settings.device == "nidaqmx") copper_.emplace(nidaqmx::read_config(settings.device_config));
  }
  void pulse() override {
    lines_.pulse();
    if (copper_) copper_->pulse();
  }
  bool failed() const { return copper_ && copper_->failed(); }

 private:
  digital_io::SupervisorIo lines_;
  std::optional<nidaqmx::PulseLine> copper_;
};

void supervise(const std::filesystem::path& run_folder) {
  live::LiveProcess process(run_folder, security::Role::Supervisor);
  Interlock interlock(process.settings());
  const digital_io::IoReader panel(process.settings().lines);
  live::SupervisorLoop loop(process.bus(), interlock, panel, process.config_tag(),
                            live::monotonic_session_id(run_folder / "session"), robot::self_test());
  process.start_ticking();
  while (!process.stop_asked()) {
    loop.turn();
    if (interlock.failed())
      loop.heartbeat().note("the board of the supervisor's pulse failed: the interlock is open");
    process.after_tick(realtime::monotonic_ns() / 1000, loop.heartbeat().health());
  }
}

}  // namespace

int main(int argc, char** argv) {
  return live::live_main(argc, argv, "supervisor", supervise);
}
