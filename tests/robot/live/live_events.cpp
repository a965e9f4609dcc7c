#include "tests/robot/live/live_events.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "drivers/digital_io/io_views.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/live/session/live_session.hpp"
#include "tests/robot/live/host_watch.hpp"
#include "tests/robot/live/live_motion.hpp"

namespace biopsy::live_tests {
namespace {

constexpr int kEdge_ms = 100;  // a square wave passes through zero

}  // namespace

EventOutcome live_event(const LiveEvent& event, const robot::LiveOptions& options,
                        const robot::PreparedCase& prepared, const std::filesystem::path& folder,
                        std::int64_t watch_ms) {
  EventOutcome outcome;
  const Plan& plan = std::get<Plan>(prepared.plan);
  std::filesystem::create_directories(folder);
  BadWire wire(folder);
  robot::LiveSession session(options, "sim", {}, prepared, folder);
  session.wait_until_healthy();
  session.send_plan(plan);
  const Motion motion = move(session, plan, event.after_ticks);
  if (!motion.pressing) {
    outcome.trouble = motion.prevented_by;
    return outcome;
  }
  const digital_io::IoReader lines(session.settings().lines);
  HostWatch host;
  std::jthread finger([&](const std::stop_token& stop) {  // stays on the button
    while (!stop.stop_requested()) session.robot().tick(*motion.pressing);
  });
  realtime::become_realtime({.lock_memory = false, .fifo_priority = 65, .cpu = std::nullopt});
  host.reset();
  const auto on_at = [&](std::int64_t ns) { return lines.load_voltage_seen_mV(ns) != 0; };
  for (int n = 0; n < kEdge_ms && !on_at(realtime::monotonic_ns()); ++n)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const std::int64_t event_ns = realtime::monotonic_ns();
  if (!on_at(event_ns)) outcome.trouble = "there was no voltage at the event";
  if (event.signal != 0) kill(session.launcher().pid_of(event.victim), event.signal);
  wire.set(event.packets);
  std::int64_t now_ns = event_ns, on_ns = event_ns, off_ns = event_ns;  // seen on last, seen off after that
  std::int64_t pulsed_ns = event_ns;
  std::uint64_t pulses = lines.supervisor_pulses();
  while (now_ns - event_ns < watch_ms * 1'000'000) {
    const bool on = on_at(now_ns);
    if (lines.supervisor_pulses() != pulses) pulses = lines.supervisor_pulses(), pulsed_ns = now_ns;
    if (on)
      outcome.unpermitted_ms =
          std::max(outcome.unpermitted_ms, static_cast<double>(now_ns - pulsed_ns) * 1e-6);
    if (on)
      on_ns = off_ns = now_ns;
    else if (off_ns == on_ns)
      off_ns = now_ns;
    // Long after the event a look now and then is enough.
    const bool near = now_ns - event_ns < 100'000'000;
    std::this_thread::sleep_for(std::chrono::microseconds(near ? 50 : 1000));
    now_ns = realtime::monotonic_ns();
  }
  realtime::become_realtime({.lock_memory = false, .fifo_priority = 0, .cpu = std::nullopt});
  const std::int64_t until_ns = off_ns == on_ns ? now_ns : off_ns;
  outcome.host_late_ms = host.worst_ms_between(event_ns / 1000, until_ns / 1000);
  outcome.packets = wire.done();
  outcome.to_zero_ms = off_ns == on_ns ? -1.0 : static_cast<double>(off_ns - event_ns) * 1e-6;
  finger.request_stop();
  finger.join();
  session.stop();
  return outcome;
}

}  // namespace biopsy::live_tests
