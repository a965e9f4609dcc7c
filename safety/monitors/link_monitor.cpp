#include "safety/monitors/link_monitor.hpp"

#include <algorithm>

#include "safety/challenge.hpp"
#include "safety/monitors/clock_step.hpp"
#include "safety/monitors/debounce.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::safety {
namespace {

// Our own clock: every call is one tick.
HazardSet look_at_clock(LinkWatch& watch, const Observation& seen) {
  const bool sound = watch.clock_read && is_sound_step(watch.now_us, seen.now_us);
  watch.clock_read = true;
  watch.now_us = seen.now_us;
  return when(!sound || seen.measurement.verdict == GateVerdict::ClockJump, Hazard::ClockJump);
}

// A stage or controller that was restarted counts from 1 again. It is taken up only after the old one had
// fallen silent and with the drive off.
constexpr bool may_restart(std::int32_t silent_ticks, Mode mode) {
  return silent_ticks > kStale_ticks && !is_hot(mode);
}

void count_missed(LinkWatch& watch, std::uint32_t missed) {
  watch.miss_score = missed > 2
                         ? kMissMax
                         : std::min(watch.miss_score + static_cast<std::int32_t>(missed) * kMiss, kMissMax);
}

struct Arrival {
  bool fresh = false;
  HazardSet found = 0;
};

Arrival look_at_measurement(LinkWatch& watch, const Observation& seen) {
  const Measurement& m = seen.measurement;
  const bool again = m.seq == watch.seq;
  const bool backwards = m.seq < watch.seq;
  const bool fresh = !again && (!backwards || may_restart(watch.stale_ticks, seen.permit.mode));
  const bool in_order = m.seq == watch.seq + 1;
  const bool follows = fresh && in_order && watch.seq != 0;
  const bool jumped = follows && !is_sound_step(watch.stage_us, m.time_us);
  if (follows && !jumped && m.time_us - watch.stage_us >= kStageLate_us) count_missed(watch, 1);
  if (!again) watch.order_score = scored(watch.order_score, in_order);
  if (fresh) watch.seq = m.seq, watch.stage_us = m.time_us;
  watch.stale_ticks = counted(watch.stale_ticks, !fresh, kStale_ticks + 1);
  return {fresh, when(jumped, Hazard::ClockJump) |
                     when(watch.stale_ticks > kStale_ticks, Hazard::SensorStale) |
                     when(watch.order_score > kScoreTrip, Hazard::MessageOrder)};
}

bool is_right_answer(const LinkWatch& watch, const Observation& seen) {
  const Measurement& m = seen.measurement;
  const std::uint32_t age = seen.permit.seq - m.answered_seq;  // wraps to huge for an answer from the future
  if (m.answered_seq == 0 || age > kAnswerWindow || m.answered_seq < watch.answered_seq) return false;
  const std::uint32_t challenge = challenge_of(seen.permit.session, m.answered_seq);
  return m.answer ==
         answer_to(challenge, m.command_mV, watch.permit_mode[m.answered_seq % 8], m.answered_seq);
}

HazardSet look_at_answer(LinkWatch& watch, const Observation& seen, bool fresh) {
  if (seen.permit.seq == 0) return bit(Hazard::WrongAnswer);
  watch.permit_mode[seen.permit.seq % 8] = seen.permit.mode;
  const bool right = is_right_answer(watch, seen);
  const bool late = seen.permit.seq - watch.answered_seq > kAnswerWindow;
  const bool newer = seen.measurement.answered_seq != watch.answered_seq;
  if (fresh ? !right : late) watch.answer_score = scored(watch.answer_score, false);
  if (fresh && right && newer) watch.answer_score = scored(watch.answer_score, true);
  if (fresh && right) watch.answered_seq = seen.measurement.answered_seq;
  return when(watch.answer_score > kScoreTrip, Hazard::WrongAnswer);
}

// A controller answers measurements: its silence counts only where there was one to answer.
HazardSet look_at_controller(LinkWatch& watch, const Observation& seen, bool measured) {
  const DriveRequest& request = seen.request;
  const bool fresh = request.seq > watch.request_seq ||
                     (request.seq != watch.request_seq && may_restart(watch.silent_ticks, seen.permit.mode));
  const std::uint32_t missed = request.overruns - watch.overruns;
  if (fresh && request.seq > watch.request_seq && watch.request_seq != 0) count_missed(watch, missed);
  if (fresh) watch.request_seq = request.seq, watch.overruns = request.overruns;
  if (fresh || measured) watch.silent_ticks = counted(watch.silent_ticks, !fresh, kStale_ticks + 1);
  const bool overrun = watch.miss_score > kMissTrip;
  watch.miss_score = std::max(watch.miss_score - 1, 0);
  return when(overrun, Hazard::LoopOverrun) |
         when(watch.silent_ticks > kStale_ticks, Hazard::ControllerSilent);
}

HazardSet look_at_estop(LinkWatch& watch, const Observation& seen) {
  const bool differs = seen.estop_a_closed != seen.estop_b_closed;
  watch.estop_differs_ticks = counted(watch.estop_differs_ticks, differs, kEStopDisagree_ticks + 1);
  if (watch.estop_differs_ticks > kEStopDisagree_ticks) watch.estop_latched = true;
  const bool latched = watch.estop_latched;
  if (!seen.estop_a_closed && !seen.estop_b_closed)
    watch.estop_latched = false;  // both work again: from the next tick
  return when(!seen.estop_a_closed || !seen.estop_b_closed, Hazard::EStop) |
         when(latched, Hazard::EStopDisagrees);
}

HazardSet look_at_patient(const PlanFacts& plan, LinkWatch& watch, const Observation& seen) {
  const bool unlike = seen.tissue_residual_um < 0 || seen.tissue_residual_um > plan.tissue_residual_max_um;
  const bool moved = seen.patient_motion_um < 0 || seen.patient_motion_um > kPatientMotion_um;
  watch.residual_ticks = counted(watch.residual_ticks, unlike, kWrongModel_ticks);
  return when(watch.residual_ticks >= kWrongModel_ticks, Hazard::WrongTissueModel) |
         when(watch.residual_ticks >= kSuspect_ticks, Hazard::SuspectTissueModel) |
         when(moved, Hazard::PatientMotion);
}

// The numbers of a plan are judged while nothing moves; in motion the tag stands for them.
HazardSet look_at_plan(const PlanFacts& plan, LinkWatch& watch, const Observation& seen) {
  if (!is_hot(seen.permit.mode)) watch.plan_plausible = is_plausible(plan);
  const bool same_plan = plan.plan_tag != 0 && seen.plan_tag == plan.plan_tag;
  const bool same_config = plan.config_tag != 0 && seen.config_tag == plan.config_tag;
  const bool for_patient = plan.bench_half_period_ticks == 0;
  const bool confirmed = seen.confirmed_tag[0] == plan.plan_tag && seen.confirmed_tag[1] == plan.plan_tag &&
                         (for_patient || seen.bench_confirmed);
  return when(!same_plan, Hazard::PlanChanged) | when(!same_config, Hazard::ConfigChanged) |
         when(!watch.plan_plausible, Hazard::PlanImplausible) |
         when(!confirmed || plan.plan_tag == 0, Hazard::PlanUnconfirmed);
}

HazardSet look_at_writers_and_log(const Observation& seen) {
  const bool second = seen.writers != 1 || seen.measurement.verdict == GateVerdict::SecondWriter;
  const bool behind = seen.log_backlog_ms < 0 || seen.log_backlog_ms > kLogBacklog_ms;
  return when(second, Hazard::SecondWriter) | when(behind, Hazard::LogBacklog);
}

}  // namespace

LinkFindings look(const PlanFacts& plan, LinkWatch& watch, const Observation& seen) {
  HazardSet found = look_at_clock(watch, seen);
  const Arrival arrival = look_at_measurement(watch, seen);
  found |= arrival.found;
  found |= look_at_answer(watch, seen, arrival.fresh);
  found |= look_at_controller(watch, seen, arrival.fresh);
  found |= look_at_estop(watch, seen);
  found |= look_at_patient(plan, watch, seen);
  found |= look_at_plan(plan, watch, seen);
  found |= look_at_writers_and_log(seen);
  return {found, arrival.fresh};
}

}  // namespace biopsy::safety
