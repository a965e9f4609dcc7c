// biopsy-supervisor RUN_FOLDER: decides the permit.
#include <array>
#include <memory>

#include "drivers/needle_stage_factory.hpp"
#include "robot/cycle/self_test.hpp"
#include "robot/live/live_process.hpp"
#include "robot/live/monotonic_session_id.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/live/supervisor_loop.hpp"

namespace {

using namespace biopsy;
using logging::Level;
using logging::TickEvent;

constexpr TickEvent kBoardFailed{Level::Error,
                                 "the board of the supervisor's pulse failed: the interlock is open"};
// In the order of Mode.
constexpr std::array kModes{
    TickEvent{Level::Info, "mode boot"},    TickEvent{Level::Info, "mode safe"},
    TickEvent{Level::Info, "mode ready"},   TickEvent{Level::Info, "mode armed"},
    TickEvent{Level::Info, "mode active"},  TickEvent{Level::Info, "mode hold"},
    TickEvent{Level::Info, "mode retract"}, TickEvent{Level::Info, "mode trip"},
    TickEvent{Level::Info, "mode lock"},
};

// The supervisor's half of the interlock: the simulated digital I/O, and the board's line where there is one.
class SupervisorPulse final : public drivers::PulseOutput {
 public:
  explicit SupervisorPulse(const live::LiveSettings& settings) : io_(settings.lines) {
    if (!drivers::is_simulated(settings.device))
      board_ = drivers::make_supervisor_pulse(settings.device, settings.device_config);
  }
  void pulse() override {
    io_.pulse();
    if (board_) board_->pulse();
  }
  bool failed() const override { return board_ && board_->failed(); }

 private:
  digital_io::SupervisorIo io_;
  std::unique_ptr<drivers::PulseOutput> board_;
};

void supervise(const std::filesystem::path& run_folder) {
  live::LiveProcess process(run_folder, security::Role::Supervisor);
  SupervisorPulse pulse(process.settings());
  const digital_io::IoReader panel(process.settings().lines);
  const live::ConfigWatch config(run_folder, process.settings());
  live::SupervisorLoop loop(process.bus(), pulse, panel, config.files(), process.config_tag(),
                            live::monotonic_session_id(live::own_folder(run_folder) / "session"),
                            robot::self_test(), !drivers::is_simulated(process.settings().device));
  process.start_ticking();
  const auto now_us = [] { return realtime::monotonic_ns() / 1000; };
  bool failed = false;
  Mode mode = loop.mode();
  while (!process.stop_asked()) {
    loop.turn();
    if (pulse.failed())
      loop.heartbeat().note("the board of the supervisor's pulse failed: the interlock is open");
    if (pulse.failed() && !failed) process.tick_log().record(kBoardFailed, now_us());
    failed = pulse.failed();
    if (loop.mode() != mode)
      process.tick_log().record(kModes[static_cast<std::size_t>(loop.mode())], now_us());
    mode = loop.mode();
    process.after_tick(now_us(), loop.heartbeat().health());
  }
}

}  // namespace

int main(int argc, char** argv) {
  return live::live_main(argc, argv, "supervisor", supervise);
}
