#include "robot/live/supervisor_loop.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "planner/plan/open_plan.hpp"
#include "planner/plan/seal.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::live {
namespace {

using std::chrono::microseconds;

// A measurement every millisecond: half a period of patience with the first that is late, then one tick a
// millisecond without, so that the detectors' ticks stay milliseconds.
constexpr std::int64_t kPatience_us = 1'500, kTick_us = 1'000;
constexpr int kBurst = 16;                    // measurements of a stall, one tick each
constexpr std::int64_t kActOld_us = 500'000;  // what the person's side says is then unknown
constexpr std::int32_t kUnknown = std::numeric_limits<std::int32_t>::max();

std::int64_t now_in_us() {
  return realtime::monotonic_ns() / 1000;
}

std::int64_t wall_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

template <class Enum>
std::uint8_t code_of(Enum value) {
  return static_cast<std::uint8_t>(value);
}

}  // namespace

SupervisorLoop::SupervisorLoop(const transport::Participant& bus, drivers::PulseOutput& interlock,
                               const digital_io::IoReader& panel, std::uint64_t config_tag,
                               std::uint32_t session, safety::SelfTest self_test)
    : interlock_(interlock),
      panel_(panel),
      measurements_(bus),
      requests_(bus),
      acts_(bus),
      plans_(bus),
      verdicts_(bus),
      log_(bus),
      permits_(bus),
      decisions_(bus),
      wait_set_(bus),
      heartbeat_(bus, Process::Supervisor, config_tag),
      config_tag_(config_tag),
      self_test_(self_test),
      state_(safety::started(session)) {
  wait_set_.add(measurements_);
  heartbeat_.health().ready = true;
}

void SupervisorLoop::turn() {
  const std::int64_t patience = measurement_late_ ? kTick_us : kPatience_us;
  const std::int64_t left = ticked_us_ + patience - now_in_us();
  wait_set_.wait(microseconds(std::max<std::int64_t>(left, 0)));
  const std::int64_t woke_us = now_in_us();
  listen(woke_us);
  take_burst();
  for (std::size_t i = 0; i < burst_.measurements; ++i) {
    measured_ = burst_.measured[i];
    // After a stall of ours requests have queued as measurements have: each tick sees its own.
    const std::size_t after = burst_.measurements - 1 - i;
    if (burst_.requests > after) request_ = burst_.requested[burst_.requests - 1 - after];
    std::int64_t now_us = now_in_us();
    while (now_us == ticked_us_) now_us = now_in_us();  // two ticks are never at the same time
    tick(now_us);
  }
  measurement_late_ = burst_.measurements == 0;
  if (!measurement_late_ || woke_us - ticked_us_ < patience) return;
  if (burst_.requests > 0) request_ = burst_.requested[burst_.requests - 1];
  tick(woke_us);
}

void SupervisorLoop::take_burst() {
  burst_.measurements = burst_.requests = 0;
  while (burst_.measurements < Burst::kMost && measurements_.take(burst_.measured[burst_.measurements]))
    ++burst_.measurements;
  while (burst_.requests < Burst::kMost && requests_.take(burst_.requested[burst_.requests]))
    ++burst_.requests;
}

// What need not be looked at in its order.
void SupervisorLoop::listen(std::int64_t now_us) {
  if (acts_.take_newest(act_) > 0) act_us_ = now_us, act_is_new_ = true;
  verdicts_.take_newest(verdict_);
  if (log_.take_newest(logged_) > 0) logged_us_ = now_us;
  take_plan();
}

// At rest a new plan is taken up. In motion it is only noticed: its tag is not the sealed one any more.
void SupervisorLoop::take_plan() {
  SealedPlan sealed;
  if (plans_.take_newest(sealed) == 0) return;
  const std::optional<Plan> plan = planner::open_plan(sealed.bytes, sealed.seal);
  sealed_tag_ = plan ? planner::plan_tag(*plan) : 0;
  if (safety::hv_permitted(state_.mode)) return;
  const bool fits =
      plan && plan->stages.size() <= safety::kMaxSteps && plan->limits.plausible.size() <= safety::kMaxBands;
  facts_ = fits ? plan_facts(*plan, config_tag_) : safety::PlanFacts{};
  confirmed_ = sealed.confirmed_tag;
  heartbeat_.health().plan_tag = facts_.plan_tag;
}

// The worst of the topics that must have exactly one writer. Plans, verdicts and the log's word may have
// none: then nothing is permitted for want of them.
std::int32_t SupervisorLoop::writers() const {
  for (const int count : {measurements_.writers(), requests_.writers(), acts_.writers()})
    if (count != 1) return count;
  if (measurements_.alive_writers() != 1 || requests_.alive_writers() != 1) return 0;
  for (const int count : {plans_.writers(), verdicts_.writers(), log_.writers()})
    if (count > 1) return count;
  return 1;
}

safety::Observation SupervisorLoop::observed(std::int64_t now_us) {
  const bool act_known = act_us_ != 0 && now_us - act_us_ <= kActOld_us;
  const digital_io::PanelLevels panel = panel_.panel();
  safety::Observation seen;
  seen.now_us = now_us;
  seen.measurement = measured_;
  seen.request = request_;
  seen.permit = permit_;
  seen.writers = writers();
  seen.estop_a_closed = panel.estop_a_closed;
  seen.estop_b_closed = panel.estop_b_closed;
  seen.acquiring = !act_known || act_.acquiring;
  if (logged_us_ != 0)
    seen.log_backlog_ms = static_cast<std::int32_t>(
        std::min<std::int64_t>(logged_.backlog_ms + (now_us - logged_us_) / 1000, kUnknown));
  seen.patient_motion_um = act_known ? act_.patient_motion_um : kUnknown;
  seen.tissue_residual_um = safety::tissue_residual_um(facts_, tissue_, measured_);
  // What the controller really runs, and what was sent last: both must be what was sealed and permitted. Each
  // says it in the messages that nobody else may write.
  seen.plan_tag = sealed_tag_ == request_.plan_tag ? sealed_tag_ : 0;
  seen.config_tag =
      measured_.config_tag == config_tag_ && request_.config_tag == config_tag_ ? config_tag_ : 0;
  seen.confirmed_tag = confirmed_;
  seen.bench_confirmed = panel.bench_key;
  return seen;
}

safety::SupervisorInput SupervisorLoop::input_of(const safety::Observation& seen) {
  const bool act_known = act_us_ != 0 && seen.now_us - act_us_ <= kActOld_us;
  const digital_io::PanelLevels panel = panel_.panel();
  safety::SupervisorInput input;
  input.now_us = seen.now_us;
  input.evidence = safety::assess(facts_, memory_, seen);
  input.self_test = self_test_;
  input.local_arm = panel.arm_key;
  input.local_reset = panel.reset_key;
  if (act_known) input.stop = act_.stop;
  if (act_is_new_) {  // a press counts when it arrives: nothing that is remembered holds a button
    input.motion = {act_.token, act_.held};
    input.remote_arm = act_.arm;
    input.remote_reset = act_.reset;
    act_is_new_ = false;
  }
  input.request = request_;
  input.depth_accepted = verdict_.accepted && verdict_.plan_tag == facts_.plan_tag && facts_.plan_tag != 0;
  input.accepted_stage = verdict_.stage;
  return input;
}

void SupervisorLoop::announce(const safety::SupervisorOutput& output, std::int64_t now_us) {
  permits_.write(output.permit);
  if (output.interlock_pulse) interlock_.pulse();
  Decision decision;
  decision.seq = output.permit.seq;
  decision.time_us = now_us;
  decision.at_ns = wall_ns();
  decision.session = output.permit.session;
  decision.epoch = output.permit.epoch;
  decision.mode = output.permit.mode;
  decision.stop = output.permit.stop;
  decision.event = code_of(output.event);
  decision.worst = code_of(output.worst);
  decision.reason = code_of(output.reason);
  decision.refusal = code_of(output.refusal);
  decision.stage = output.stage;
  decision.stage_done = output.stage_done;
  decision.image_allowed = output.image_allowed;
  decision.image_disturbed = output.image_disturbed;
  decisions_.write(decision);
}

void SupervisorLoop::tick(std::int64_t now_us) {
  const safety::Observation seen = observed(now_us);
  safety::SupervisorOutput output;
  std::tie(state_, output) = safety::step(facts_, state_, input_of(seen));
  permit_ = output.permit;
  announce(output, now_us);
  if (ticked_us_ != 0) {
    const std::int64_t late_us = now_us - ticked_us_ - kTick_us;
    heartbeat_.lateness().record(late_us * 1000);
    heartbeat_.health().overruns += static_cast<std::uint32_t>(std::max<std::int64_t>(late_us, 0) / kTick_us);
  }
  ticked_us_ = now_us;
  heartbeat_.beat(now_us);
}

}  // namespace biopsy::live
