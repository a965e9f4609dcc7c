#include "tests/bench/live_soak.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <deque>

#include "robot/live/realtime/tick_clock.hpp"
#include "robot/live/session/live_session.hpp"
#include "robot/procedure/rehearsal.hpp"
#include "tests/robot/live/host_watch.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::bench {
namespace {

constexpr double kHostStall_ms = 3.0;  // a permit lives 5 ms, and R-25 waits for 3 measurements
constexpr double kClockStep_ms = 0.5;  // of the judge: a stall is up to so much longer than a wake is late
constexpr std::int64_t kBefore_us = 50'000;  // what stops a robot is seen within this time

// A robot that remembers when it first was stopped by a hazard, and the ticks around it. After a stall the
// reporter takes old measurements beside the newest decision: between the two times lies what it missed.
class Watched {
 public:
  explicit Watched(robot::LiveRobot& robot) : robot_(robot) {}

  std::optional<robot::CycleSample> tick(const robot::OperatorInputs& inputs) {
    const std::optional<robot::CycleSample> cycle = robot_.tick(inputs);
    if (!cycle) return cycle;
    if (after_ < kAfter) last_.push_back(cycle->record);
    if (last_.size() > kKept) last_.pop_front();
    const safety::SupervisorOutput& decided = cycle->record.supervisor;
    was_driven_ = was_driven_ || decided.permit.hv_enable;
    const bool off = decided.permit.mode == Mode::Trip || decided.permit.mode == Mode::Lock;
    if ((off || (was_driven_ && decided.reason != safety::Hazard::None)) && stopped_us_ == 0) {
      stopped_us_ = cycle->record.measurement.time_us;
      heard_us_ = realtime::monotonic_ns() / 1000;
    }
    if (stopped_us_ != 0) ++after_;
    return cycle;
  }
  std::int64_t stopped_us() const { return stopped_us_; }
  std::int64_t heard_us() const { return heard_us_; }
  const std::deque<robot::CycleRecord>& last() const { return last_; }

 private:
  static constexpr std::size_t kKept = 16, kAfter = 4;
  robot::LiveRobot& robot_;
  std::deque<robot::CycleRecord> last_;
  bool was_driven_ = false;
  std::int64_t stopped_us_ = 0, heard_us_ = 0;
  std::size_t after_ = 0;
};

void print_ticks(const std::deque<robot::CycleRecord>& ticks) {
  fmt::print("    {:>9}{:>10}{:>10}{:>9}{:>10}{:>10}  worst\n", "tick", "time, ms", "permit", "answered",
             "request", "gate");
  const std::int64_t from_us = ticks.front().measurement.time_us;
  for (const robot::CycleRecord& t : ticks)
    fmt::print("    {:>9}{:>10.3f}{:>10}{:>9}{:>10}{:>10}  {}\n", t.measurement.seq,
               static_cast<double>(t.measurement.time_us - from_us) * 1e-3, t.supervisor.permit.seq,
               t.measurement.answered_seq, t.request.seq, static_cast<int>(t.measurement.verdict),
               safety::name_of(t.supervisor.worst));
}

}  // namespace

void bench_soak(const robot::LiveOptions& options, const robot::PreparedCase& prepared, double minutes) {
  using Clock = std::chrono::steady_clock;
  const auto until = Clock::now() + std::chrono::duration<double, std::ratio<60>>(minutes);
  int runs = 0, completed = 0;
  double seconds = 0.0;
  std::uint64_t lost = 0;
  fmt::print("\nSoak: {:.0f} min of rehearsal\n", minutes);
  int stopped = 0, by_host = 0, maybe_by_host = 0;
  live_tests::HostWatch host;
  while (Clock::now() < until) {
    host.reset();
    const ScratchFolder folder;
    robot::LiveSession session(options, "sim", {}, prepared, folder.path());
    session.wait_until_healthy();
    session.send_plan(std::get<Plan>(prepared.plan));
    Watched watched(session.robot());
    const robot::Robot robot = [&](const robot::OperatorInputs& inputs) { return watched.tick(inputs); };
    const report::RunRecord record =
        rehearse_on(robot, prepared, folder.path(), [](double, const std::string&) {});
    ++runs;
    completed += record.outcome == report::Outcome::Completed;
    seconds += record.simulated_s;
    lost += session.robot().lost();
    const auto health = session.robot().health();
    if (!record.trips.empty() || record.outcome != report::Outcome::Completed) {
      const double late_ms = host.worst_ms_between(watched.stopped_us() - kBefore_us, watched.heard_us());
      fmt::print(
          "  run {}: {} (around it the machine was late by {:.1f} ms, in all the run by {:.1f} ms; stopped "
          "at "
          "{:.6f} s, heard at {:.6f} s, CLOCK_MONOTONIC)\n",
          runs, record.refusal, late_ms, host.worst_ms(), static_cast<double>(watched.stopped_us()) * 1e-6,
          static_cast<double>(watched.heard_us()) * 1e-6);
      ++stopped;
      by_host += late_ms > kHostStall_ms;
      maybe_by_host += late_ms <= kHostStall_ms && late_ms + kClockStep_ms > kHostStall_ms;
      print_ticks(watched.last());
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
      "{} runs, {} completed, {} stopped by a hazard: {} of them while the machine itself stood still for\n"
      "more than {} ms, {} within the {} ms in which the judge's clock can't tell, {} not;\n"
      "{:.0f} s of motion and waiting, {} ticks not received by the reporter\n",
      runs, completed, stopped, by_host, kHostStall_ms, maybe_by_host, kClockStep_ms,
      stopped - by_host - maybe_by_host, seconds, lost);
}

}  // namespace biopsy::bench
