#include "tests/bench/live_soak.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>

#include "robot/app/live_session.hpp"
#include "robot/app/rehearsal.hpp"
#include "tests/live/host_watch.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::bench {
namespace {

constexpr double kHostStall_ms = 3.0;  // a permit lives 5 ms, and is renewed each

}  // namespace

void bench_soak(const app::LiveOptions& options, const app::PreparedCase& prepared, double minutes) {
  using Clock = std::chrono::steady_clock;
  const auto until = Clock::now() + std::chrono::duration<double, std::ratio<60>>(minutes);
  int runs = 0, completed = 0;
  double seconds = 0.0;
  std::uint64_t lost = 0;
  fmt::print("\nSoak: {:.0f} min of rehearsal\n", minutes);
  int by_host = 0;
  live_tests::HostWatch host;
  while (Clock::now() < until) {
    host.reset();
    const ScratchFolder folder;
    app::LiveSession session(options, "sim", {}, prepared, folder.path());
    session.wait_until_healthy();
    session.send_plan(std::get<Plan>(prepared.plan));
    const app::Robot robot = [&](const app::World& world) { return session.robot().tick(world); };
    const report::RunRecord record =
        rehearse_on(robot, prepared, folder.path(), [](double, const std::string&) {});
    ++runs;
    completed += record.outcome == report::Outcome::Completed;
    seconds += record.simulated_s;
    lost += session.robot().lost();
    const auto health = session.robot().health();
    if (!record.trips.empty() || record.outcome != report::Outcome::Completed) {
      fmt::print("  run {}: {} (the machine was late by {:.1f} ms)\n", runs, record.refusal, host.worst_ms());
      by_host += host.worst_ms() > kHostStall_ms;
      for (const report::Trip& trip : record.trips)
        fmt::print("    {:.3f} s: {}\n", trip.time_s, trip.reason);
      for (const Process process : {Process::Supervisor, Process::Stage, Process::Controller}) {
        const Health& of = health[static_cast<std::size_t>(process)];
        fmt::print("    {}: late p99 {} us, max {} us, overruns {}\n", name_of(process), of.late_p99_us,
                   of.late_max_us, of.overruns);
      }
    }
    session.stop();
    std::fflush(stdout);
  }
  fmt::print(
      "{} runs, {} completed, {} not smooth while the machine itself was late by > {} ms,\n"
      "{:.0f} s of motion and waiting, {} ticks not received by the reporter\n",
      runs, completed, by_host, kHostStall_ms, seconds, lost);
}

}  // namespace biopsy::bench
