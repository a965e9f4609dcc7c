// biopsy-interlock FOLDER: the independent interlock on the simulated digital I/O in FOLDER. In a laboratory
// it is a relay; here it is a process that uses nothing but that I/O, safety/interlock.hpp and a clock.
#include <cstdint>
#include <filesystem>

#include "drivers/digital_io/interlock_relay.hpp"
#include "robot/common/logging/logger.hpp"
#include "robot/common/logging/program.hpp"
#include "robot/common/logging/tick_log.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/live/realtime/latency_histogram.hpp"
#include "robot/live/realtime/service_notice.hpp"
#include "robot/live/realtime/stop_signals.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace {

using namespace biopsy::realtime;

constexpr biopsy::logging::Logger kLog{biopsy::logging::Component::Interlock};
constexpr biopsy::logging::TickEvent kOverrun{biopsy::logging::Level::Info,
                                              "periods missed: {0:.0f}; woke {1:.0f} us late"};
constexpr int kPriority = 80;  // above the loops it guards

int guard(const std::filesystem::path& io_folder) {
  StopSignals stop;
  const ServiceNotice notice;
  biopsy::digital_io::InterlockRelay relay(io_folder, monotonic_ns());
  LatencyHistogram lateness;
  biopsy::logging::TickLog tick_log(
      biopsy::logging::Component::Interlock);  // before its thread would get priority
  const RealtimeObtained obtained = become_realtime({.fifo_priority = kPriority});
  kLog.info("open; {}", to_text(obtained));
  TickClock clock(biopsy::digital_io::kRelayPeriod);
  notice.ready();
  std::int64_t stroked_us = 0;
  while (!stop.came()) {
    const Wake wake = clock.wait();
    relay.tick(wake.woke_ns);
    lateness.record(wake.late_ns());
    if (wake.missed > 0)
      tick_log.record(kOverrun, wake.woke_ns / 1'000, static_cast<double>(wake.missed),
                      static_cast<double>(wake.late_ns()) * 1e-3);
    const std::int64_t now_us = wake.woke_ns / 1'000;
    const bool is_due = notice.watchdog_us() && now_us - stroked_us > *notice.watchdog_us() / 2;
    if (is_due && notice.watchdog()) stroked_us = now_us;  // no room: again with the next tick
  }
  relay.open(monotonic_ns());
  notice.stopping();
  kLog.info("open, ends; {} ticks, {} missed, late p50 {} us, p99 {} us, max {} us", lateness.count(),
            clock.missed(), lateness.p50_us(), lateness.p99_us(), lateness.max_us());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  constexpr const char* kName = "biopsy-interlock";
  return biopsy::logging::run_program(kName, [&] {
    const auto arguments = biopsy::logging::parse_arguments(kName, argc, argv);
    const biopsy::logging::LogSession log(arguments.log);
    return guard(arguments.folder);
  });
}
