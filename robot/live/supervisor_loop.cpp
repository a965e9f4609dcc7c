#include "robot/live/supervisor_loop.hpp"

#include <algorithm>

#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::live {
namespace {

using std::chrono::microseconds;

// A measurement every millisecond: half a period of patience with the first that is late, then one tick a
// millisecond without, so that the monitors' ticks stay milliseconds.
constexpr std::int64_t kPatience_us = 1'500, kTick_us = 1'000;

std::int64_t monotonic_us() {
  return realtime::monotonic_ns() / 1000;
}

std::int64_t wall_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

SupervisorLoop::SupervisorLoop(const transport::Participant& bus, drivers::PulseOutput& interlock,
                               const digital_io::IoReader& panel, const FilesTag& files,
                               std::uint64_t config_tag, std::uint32_t session, safety::SelfTest self_test,
                               bool needs_second_person)
    : interlock_(interlock),
      panel_(panel),
      files_(files),
      measurements_(bus),
      requests_(bus),
      acts_(bus),
      plans_(bus),
      confirmations_(bus),
      verdicts_(bus),
      log_(bus),
      navigation_(bus),
      permits_(bus),
      decisions_(bus),
      wait_set_(bus),
      heartbeat_(bus, Process::Supervisor, config_tag) {
  supervisor_.config_tag = config_tag;
  supervisor_.self_test = self_test;
  supervisor_.needs_second_person = needs_second_person;
  supervisor_.state = safety::started(session);
  wait_set_.add(measurements_);
  heartbeat_.health().ready = true;
}

void SupervisorLoop::turn() {
  const std::int64_t patience = measurement_late_ ? kTick_us : kPatience_us;
  const std::int64_t left = ticked_us_ + patience - monotonic_us();
  wait_set_.wait(microseconds(std::max<std::int64_t>(left, 0)));
  const std::int64_t woke_us = monotonic_us();
  take_messages(woke_us);
  take_burst();
  for (std::size_t i = 0; i < burst_.measurements; ++i) {
    sources_.measurement = burst_.measured[i];
    // After a stall requests have queued as measurements have: each tick sees its own.
    const std::size_t after = burst_.measurements - 1 - i;
    if (burst_.requests > after) sources_.request = burst_.requested[burst_.requests - 1 - after];
    std::int64_t now_us = monotonic_us();
    while (now_us == ticked_us_) now_us = monotonic_us();  // times of ticks are strictly increasing
    tick(now_us);
  }
  measurement_late_ = burst_.measurements == 0;
  if (!measurement_late_ || woke_us - ticked_us_ < patience) return;
  if (burst_.requests > 0) sources_.request = burst_.requested[burst_.requests - 1];
  tick(woke_us);
}

void SupervisorLoop::take_burst() {
  burst_.measurements = burst_.requests = 0;
  while (burst_.measurements < Burst::kMost && measurements_.take(burst_.measured[burst_.measurements]))
    ++burst_.measurements;
  while (burst_.requests < Burst::kMost && requests_.take(burst_.requested[burst_.requests]))
    ++burst_.requests;
}

// Of these only the newest counts.
void SupervisorLoop::take_messages(std::int64_t now_us) {
  if (acts_.take_newest(sources_.act.message) > 0) sources_.act.at_us = now_us;
  if (log_.take_newest(sources_.log.message) > 0) sources_.log.at_us = now_us;
  verdicts_.take_newest(sources_.verdict);
  // Optional, as its process is: with a second writer nobody knows whose sensor it is, and it grows old.
  if (NavigationRequest asked; navigation_.take_newest(asked) > 0 && navigation_.writers() == 1)
    sources_.navigation = {asked, now_us};
  if (SealedPlan sealed; plans_.take_newest(sealed) > 0) {
    robot::accept_plan(sealed, supervisor_);
    heartbeat_.health().plan_tag = supervisor_.plan.plan_tag;
  }
  if (PlanConfirmation given; confirmations_.take_newest(given) > 0)
    robot::confirm_plan(given, now_us, supervisor_);
}

robot::WriterCounts SupervisorLoop::writers() const {
  return {.measurements = measurements_.writers(),
          .requests = requests_.writers(),
          .acts = acts_.writers(),
          .measurements_alive = measurements_.alive_writers(),
          .requests_alive = requests_.alive_writers(),
          .plans = plans_.writers(),
          .verdicts = verdicts_.writers(),
          .log = log_.writers()};
}

void SupervisorLoop::tick(std::int64_t now_us) {
  sources_.now_us = now_us;
  sources_.panel = panel_.panel(realtime::monotonic_ns());
  sources_.files_read_us = files_.read_us();
  sources_.files_tag = files_.at(now_us);
  sources_.writers = robot::writer_count(writers());
  const robot::Supervision supervision = robot::supervise(sources_, supervisor_);
  if (supervisor_.arm_turned_us > sources_.files_read_us) files_.ask();
  const safety::SupervisorOutput& output = supervision.output;
  permits_.write(output.permit);
  if (output.interlock_pulse) interlock_.pulse();
  decisions_.write(robot::decision_message(supervision, now_us, wall_ns()));
  if (ticked_us_ != 0) {
    const std::int64_t late_us = now_us - ticked_us_ - kTick_us;
    heartbeat_.lateness().record(late_us * 1000);
    heartbeat_.health().overruns += static_cast<std::uint32_t>(std::max<std::int64_t>(late_us, 0) / kTick_us);
  }
  ticked_us_ = now_us;
  heartbeat_.beat(now_us);
}

}  // namespace biopsy::live
