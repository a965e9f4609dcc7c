// biopsy-interlock RUN_FOLDER: the independent interlock on simulated lines. In a laboratory it is a relay;
// here it is a process of its own, which knows nothing but the lines, safety/interlock.hpp and a clock.
#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>

#include "drivers/digital_io/interlock_relay.hpp"
#include "robot/common/config_error.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/live/realtime/latency_histogram.hpp"
#include "robot/live/realtime/service_notice.hpp"
#include "robot/live/realtime/stop_signals.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace {

using namespace biopsy::realtime;

constexpr int kPriority = 80;  // above the loops it guards: it must see them stand still

// Open first, then say so. Killed instead, it says nothing: who reads the lines counts it as open after
// 20 ms.
int guard(const std::filesystem::path& run_folder) {
  StopSignals stop;
  const ServiceNotice notice;
  biopsy::digital_io::InterlockRelay relay(run_folder, monotonic_ns());
  LatencyHistogram lateness;
  const RealtimeObtained obtained = become_realtime({.fifo_priority = kPriority});
  fmt::print("interlock: open; {}\n", to_text(obtained));
  std::fflush(stdout);
  TickClock clock(biopsy::digital_io::kRelayPeriod);
  notice.ready();
  std::int64_t told_us = 0;
  while (!stop.came()) {
    const Wake wake = clock.wait();
    relay.tick(wake.woke_ns);
    lateness.record(wake.late_ns());
    const std::int64_t now_us = wake.woke_ns / 1'000;
    if (notice.watchdog_us() && now_us - told_us > *notice.watchdog_us() / 2) {
      notice.watchdog();
      told_us = now_us;
    }
  }
  relay.open(monotonic_ns());
  notice.stopping();
  fmt::print("interlock: open, ends; {} ticks, {} missed, late p50 {} us, p99 {} us, max {} us\n",
             lateness.count(), clock.missed(), lateness.p50_us(), lateness.p99_us(), lateness.max_us());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2)
      throw biopsy::ConfigError("wants one argument", "biopsy-interlock", "biopsy-interlock RUN_FOLDER");
    return guard(argv[1]);
  } catch (const biopsy::ConfigError& error) {
    fmt::print(stderr, "error: {}\nwhere: {}\nto do: {}\n", error.what_is_wrong, error.where, error.remedy);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\nwhere: biopsy-interlock\nto do: report this with what led to it\n",
               error.what());
  }
  return 2;
}
