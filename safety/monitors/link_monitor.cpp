#include "safety/monitors/link_monitor.hpp"

#include <algorithm>

#include "safety/challenge.hpp"
#include "safety/monitors/clock_step.hpp"
#include "safety/monitors/debounce.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::safety {
namespace {

constexpr std::int64_t kMillisecond_us = 1'000;

// Our own clock: every call is one tick. What a tick exceeds its milliseconds by is counted in the next one;
// a clock that cannot be trusted counts a millisecond a tick.
HazardSet check_clock(LinkMonitor& monitor, const SupervisorInputs& seen, std::int32_t& elapsed_ms) {
  const bool sound = monitor.clock_read && is_sound_step(monitor.now_us, seen.now_us);
  const std::int64_t since_us = sound ? seen.now_us - monitor.counted_us : kMillisecond_us;
  elapsed_ms = static_cast<std::int32_t>(since_us / kMillisecond_us);
  monitor.counted_us = sound ? monitor.counted_us + elapsed_ms * kMillisecond_us : seen.now_us;
  monitor.clock_read = true;
  monitor.now_us = seen.now_us;
  return when(!sound || seen.measurement.verdict == GateVerdict::ClockJump, Hazard::ClockJump);
}

// A stage or controller that was restarted counts from 1 again. It is taken up only after the old one had
// fallen silent and with the drive off.
constexpr bool may_restart(std::int32_t silent_ticks, Mode mode) {
  return silent_ticks > kStale_ticks && !hv_permitted(mode);
}

void count_missed(LinkMonitor& monitor, std::uint32_t missed) {
  monitor.miss_score =
      missed > 2 ? kMissMax
                 : std::min(monitor.miss_score + static_cast<std::int32_t>(missed) * kMiss, kMissMax);
}

struct Arrival {
  bool fresh = false;
  HazardSet found = 0;
};

Arrival check_measurement(LinkMonitor& monitor, const SupervisorInputs& seen) {
  const Measurement& m = seen.measurement;
  const bool again = m.seq == monitor.seq;
  const bool backwards = m.seq < monitor.seq;
  const bool fresh = !again && (!backwards || may_restart(monitor.stale_ticks, seen.permit.mode));
  const bool in_order = m.seq == monitor.seq + 1;
  const bool follows = fresh && in_order && monitor.seq != 0;
  const bool jumped = follows && !is_sound_step(monitor.stage_us, m.time_us);
  if (follows && !jumped && m.time_us - monitor.stage_us >= kStageLate_us) count_missed(monitor, 1);
  if (!again) monitor.order_score = error_counter(monitor.order_score, in_order);
  if (fresh) monitor.seq = m.seq, monitor.stage_us = m.time_us;
  monitor.stale_ticks = debounced(monitor.stale_ticks, !fresh, kStale_ticks + 1);
  return {fresh, when(jumped, Hazard::ClockJump) |
                     when(monitor.stale_ticks > kStale_ticks, Hazard::SensorStale) |
                     when(monitor.order_score > kScoreTrip, Hazard::MessageOrder)};
}

bool is_right_answer(const LinkMonitor& monitor, const SupervisorInputs& seen) {
  const Measurement& m = seen.measurement;
  const std::uint32_t age = seen.permit.seq - m.answered_seq;  // wraps to huge for an answer from the future
  if (m.answered_seq == 0 || age > kAnswerWindow || m.answered_seq < monitor.answered_seq) return false;
  const std::uint32_t challenge = challenge_of(seen.permit.session, m.answered_seq);
  return m.answer ==
         answer_to(challenge, m.command_mV, monitor.permit_mode[m.answered_seq % 8], m.answered_seq);
}

// A stage that no permit reached in time took the voltage off by itself: that is no disobedience.
bool is_permit_expired(const SupervisorInputs& seen) {
  return hv_permitted(seen.permit.mode) && seen.measurement.verdict == GateVerdict::Expired;
}

HazardSet check_answer(LinkMonitor& monitor, const SupervisorInputs& seen, bool fresh) {
  if (seen.permit.seq == 0) return bit(Hazard::WrongAnswer);
  monitor.permit_mode[seen.permit.seq % 8] = seen.permit.mode;
  const bool right = is_right_answer(monitor, seen);
  const bool late = seen.permit.seq - monitor.answered_seq > kAnswerWindow;
  const bool newer = seen.measurement.answered_seq != monitor.answered_seq;
  if (fresh ? !right : late) monitor.answer_score = error_counter(monitor.answer_score, false);
  if (fresh && right && newer) monitor.answer_score = error_counter(monitor.answer_score, true);
  if (fresh && right) monitor.answered_seq = seen.measurement.answered_seq;
  return when(monitor.answer_score > kScoreTrip || is_permit_expired(seen), Hazard::WrongAnswer);
}

// A controller answers measurements: its silence counts only where there was one to answer.
HazardSet check_controller(LinkMonitor& monitor, const SupervisorInputs& seen, bool measured) {
  const DriveRequest& request = seen.request;
  const bool fresh =
      request.seq > monitor.request_seq ||
      (request.seq != monitor.request_seq && may_restart(monitor.silent_ticks, seen.permit.mode));
  const std::uint32_t missed = request.overruns - monitor.overruns;
  if (fresh && request.seq > monitor.request_seq && monitor.request_seq != 0) count_missed(monitor, missed);
  if (fresh) monitor.request_seq = request.seq, monitor.overruns = request.overruns;
  if (fresh || measured) monitor.silent_ticks = debounced(monitor.silent_ticks, !fresh, kStale_ticks + 1);
  const bool overrun = monitor.miss_score > kMissTrip;
  monitor.miss_score = std::max(monitor.miss_score - 1, 0);
  return when(overrun, Hazard::LoopOverrun) |
         when(monitor.silent_ticks > kStale_ticks, Hazard::ControllerSilent);
}

HazardSet check_patient(const PlanFacts& plan, LinkMonitor& monitor, const SupervisorInputs& seen) {
  const bool unlike = seen.tissue_residual_um < 0 || seen.tissue_residual_um > plan.tissue_residual_max_um;
  const bool moved = seen.patient_motion_um < 0 || seen.patient_motion_um > kPatientMotion_um;
  monitor.residual_ticks = debounced(monitor.residual_ticks, unlike, kWrongModel_ticks);
  return when(monitor.residual_ticks >= kWrongModel_ticks, Hazard::WrongTissueModel) |
         when(monitor.residual_ticks >= kSuspect_ticks, Hazard::SuspectTissueModel) |
         when(moved, Hazard::PatientMotion);
}

// The numbers of a plan are judged while nothing moves; in motion the tag stands for them.
HazardSet check_plan(const PlanFacts& plan, LinkMonitor& monitor, const SupervisorInputs& seen) {
  if (!hv_permitted(seen.permit.mode)) monitor.plan_plausible = is_plausible(plan);
  const bool same_plan = plan.plan_tag != 0 && seen.plan_tag == plan.plan_tag;
  const bool same_config = plan.config_tag != 0 && seen.config_tag == plan.config_tag;
  const bool for_patient = plan.bench_half_period_ticks == 0;
  const bool confirmed = seen.confirmed_tag[0] == plan.plan_tag && seen.confirmed_tag[1] == plan.plan_tag &&
                         (for_patient || seen.bench_confirmed);
  return when(!same_plan, Hazard::PlanChanged) | when(!same_config, Hazard::ConfigChanged) |
         when(!monitor.plan_plausible, Hazard::PlanImplausible) |
         when(!confirmed || plan.plan_tag == 0, Hazard::PlanUnconfirmed);
}

HazardSet check_writers_and_log(const SupervisorInputs& seen) {
  const bool second = seen.writers != 1 || seen.measurement.verdict == GateVerdict::SecondWriter;
  const bool behind = seen.log_backlog_ms < 0 || seen.log_backlog_ms > kLogBacklog_ms;
  return when(second, Hazard::SecondWriter) | when(behind, Hazard::LogBacklog);
}

}  // namespace

LinkFindings update(const PlanFacts& plan, LinkMonitor& monitor, const SupervisorInputs& seen) {
  std::int32_t elapsed_ms = 1;
  HazardSet found = check_clock(monitor, seen, elapsed_ms);
  const Arrival arrival = check_measurement(monitor, seen);
  found |= arrival.found;
  found |= check_answer(monitor, seen, arrival.fresh);
  found |= check_controller(monitor, seen, arrival.fresh);
  found |= check_patient(plan, monitor, seen);
  found |= check_plan(plan, monitor, seen);
  found |= check_writers_and_log(seen);
  return {found, arrival.fresh, elapsed_ms};
}

}  // namespace biopsy::safety
