// Absence means no: what nobody filled in proves nothing, allows nothing and has seen nothing.
#include <gtest/gtest.h>

#include <limits>

#include "safety/gate.hpp"
#include "safety/interlock.hpp"
#include "safety/monitors/evidence.hpp"
#include "safety/monitors/panel_filter.hpp"
#include "safety/monitors/tissue_monitor.hpp"
#include "safety/supervisor.hpp"
#include "tests/safety/situation.hpp"

namespace biopsy::safety {
namespace {

constexpr std::int32_t kUnknown = std::numeric_limits<std::int32_t>::max();

template <class... Values>
bool are_zero(const Values&... values) {  // false for a bool
  return ((values == Values{}) && ...);
}

TEST(Defaults, OfInputsHaveSeenNothingAndAskForNothing) {
  const SupervisorInputs seen;
  EXPECT_TRUE(are_zero(seen.now_us, seen.writers, seen.panel_read, seen.relay_closed, seen.estop_a_closed,
                       seen.estop_b_closed, seen.plan_tag, seen.config_tag, seen.bench_confirmed,
                       seen.accepted_session, seen.accepted_since_seq));
  EXPECT_TRUE(seen.acquiring);
  EXPECT_EQ(seen.stop, StopCategory::C0Off);
  for (const std::int32_t unknown : {seen.log_backlog_ms, seen.patient_motion_um, seen.tissue_residual_um})
    EXPECT_EQ(unknown, kUnknown);
  const Situation input;
  EXPECT_TRUE(are_zero(input.local_arm, input.local_reset, input.remote_arm, input.remote_reset,
                       input.motion.token, input.motion.held, input.depth_accepted, input.accepted_step));
  EXPECT_EQ(input.self_test, SelfTest::Pending);
}

TEST(Defaults, OfEvidenceProveNothing) {
  const Evidence evidence;
  EXPECT_TRUE(are_zero(evidence.clear, evidence.zero_volts, evidence.needle_home, evidence.needle_back,
                       evidence.locked, evidence.still, evidence.interlock_opens, evidence.estop_reset,
                       evidence.drive_mV, evidence.ceiling_mV));
  EXPECT_TRUE(evidence.image_disturbed);
  EXPECT_EQ(evidence.elapsed_ms, 1) << "a tick is a millisecond";
}

TEST(Defaults, OfASupervisorAreBootWithBothKeysTakenAsHeld) {
  const SupervisorState state;
  EXPECT_EQ(state.mode, Mode::Boot);
  EXPECT_EQ(state.last_event, Event::None);
  EXPECT_EQ(state.reason, Hazard::None);
  EXPECT_TRUE(state.arm_was_down && state.reset_was_down);
  EXPECT_EQ(state.epoch, 1U);
  EXPECT_TRUE(are_zero(state.step_done, state.session, state.seq, state.token, state.step, state.arrived_seq,
                       state.ms_in_mode, state.ms_since_held, state.held_mV));
  EXPECT_EQ(started(6).session, 6U);
}

TEST(Defaults, OfAnOutputAllowNothing) {
  const SupervisorOutput output;
  EXPECT_EQ(output.event, Event::None);
  EXPECT_EQ(output.worst, Hazard::None);
  EXPECT_EQ(output.reason, Hazard::None);
  EXPECT_EQ(output.refusal, Refusal::Locked);
  EXPECT_TRUE(are_zero(output.step, output.step_done, output.image_allowed, output.interlock_pulse));
  EXPECT_TRUE(output.image_disturbed);
}

TEST(Defaults, OfAGateAreOffAndBoundToNobody) {
  const GateState state;
  EXPECT_TRUE(are_zero(state.permit_us, state.now_us, state.request_seq, state.drive_mV, state.enabled,
                       state.brake_on, state.started));
  EXPECT_EQ(state.latched, GateVerdict::Granted);
  const GateResult result{state};
  EXPECT_EQ(result.verdict, GateVerdict::Refused);
  EXPECT_TRUE(are_zero(result.answer, result.answered_seq, result.voltage.mV(), result.voltage.hv_enabled(),
                       result.voltage.brake_on(), result.voltage.feeds_interlock()));
}

TEST(Defaults, OfAPlanPlanNothing) {
  const PlanFacts plan;
  EXPECT_TRUE(are_zero(plan.plan_tag, plan.config_tag, plan.depth_max_um, plan.tissue_residual_max_um,
                       plan.bench_half_period_ticks, plan.step_count, plan.band_count));
  const StepLimits step;
  EXPECT_TRUE(are_zero(step.depth_max_um, step.v_max_mV, step.slew_up_mV_per_tick));
  EXPECT_TRUE(step.image_confirms);
  const PlausibleBand band;
  EXPECT_TRUE(are_zero(band.drive_mV, band.low_um, band.high_um));
  const DepthRange range;
  EXPECT_TRUE(are_zero(range.low_um, range.high_um));
}

TEST(Defaults, OfTheLinkMonitorTakeAllForSilentAndNothingForProven) {
  const LinkMonitor monitor;
  EXPECT_TRUE(are_zero(monitor.clock_read, monitor.now_us, monitor.counted_us, monitor.seq, monitor.stage_us,
                       monitor.order_score, monitor.answered_seq, monitor.request_seq, monitor.overruns,
                       monitor.miss_score, monitor.residual_ticks, monitor.plan_plausible));
  for (const std::int32_t silent : {monitor.stale_ticks, monitor.silent_ticks, monitor.answer_score})
    EXPECT_EQ(silent, 4);
  EXPECT_TRUE(are_zero(LinkFindings{}.found, LinkFindings{}.fresh));
  EXPECT_EQ(LinkFindings{}.elapsed_ms, 1);
}

TEST(Defaults, OfThePanelMonitorTakeAllForUntested) {
  const PanelMonitor monitor;
  EXPECT_TRUE(are_zero(static_cast<int>(monitor.test), monitor.tested_us, monitor.pressed,
                       monitor.differs_ticks, monitor.differed, monitor.relay_ticks, monitor.open_ticks));
  EXPECT_TRUE(monitor.reset_was_down);
  const PanelFindings findings;
  EXPECT_TRUE(are_zero(findings.found, findings.reset, findings.interlock_opens));
}

TEST(Defaults, OfTheVoltageMonitorHaveSeenNoZeroVolts) {
  const VoltageMonitor monitor;
  EXPECT_TRUE(are_zero(monitor.found, monitor.command_mV, monitor.over_ticks, monitor.arc_score,
                       monitor.disagree_score, monitor.disobey_ticks, monitor.zero_ticks,
                       monitor.nonzero_ticks, monitor.zero_volts, monitor.off_ticks, monitor.signed_mVms,
                       monitor.total_mVms, monitor.wave_ticks, monitor.flips, monitor.tick, monitor.polarity,
                       monitor.wrong_frequency, monitor.pull_V2, monitor.ceiling_mV, monitor.brake_on,
                       monitor.locked_mV));
  for (const Permitted& permit : monitor.permitted)
    EXPECT_TRUE(are_zero(permit.v_max_mV, permit.hv_enable, permit.brake));
  const Permitted permit;
  EXPECT_TRUE(are_zero(permit.v_max_mV, permit.hv_enable, permit.brake));
  const DriveFindings findings;
  EXPECT_TRUE(are_zero(findings.found, findings.zero_volts, findings.drive_mV, findings.ceiling_mV));
  EXPECT_TRUE(findings.image_disturbed);
}

TEST(Defaults, OfTheDepthMonitorHaveSeenNoTargetAndNoNeedleAtHome) {
  const DepthMonitor monitor;
  EXPECT_TRUE(are_zero(monitor.found, monitor.needle_home, monitor.needle_back, monitor.history.next,
                       monitor.history.newest, monitor.history.before, monitor.window.block,
                       monitor.window.ticks, monitor.window.past_low_mV, monitor.window.past_high_mV,
                       monitor.range_tag, monitor.deepest_um, monitor.sunk_ticks, monitor.lowered_mV,
                       monitor.creeping_ticks, monitor.over_ticks, monitor.hard_ticks, monitor.step_ticks,
                       monitor.pop_ticks, monitor.implausible_ticks, monitor.not_back_ticks,
                       monitor.same_code_ticks, monitor.code, monitor.frozen_low_mV, monitor.frozen_high_mV,
                       monitor.advanced_um, monitor.idle_ticks, monitor.pull_V2, monitor.rest_pull_V2,
                       monitor.locked_um, monitor.locked_ms, monitor.slip_ticks, monitor.settling_ticks));
  EXPECT_EQ(monitor.range_low_mV, -1) << "no drive: the range is looked up at the first";
  EXPECT_EQ(monitor.range_high_mV, -1);
  EXPECT_EQ(monitor.dropout_score, kDropoutTrip);
  const DepthFindings findings;
  EXPECT_TRUE(
      are_zero(findings.found, findings.needle_home, findings.needle_back, findings.locked, findings.still));
}

TEST(Defaults, OfTheAgreementMonitorHaveSeenNoSecondLaser) {
  const AgreementMonitor monitor;
  EXPECT_TRUE(are_zero(monitor.found, monitor.differ_score));
  EXPECT_EQ(monitor.dropout_score, kDropoutTrip);
}

TEST(Defaults, OfThePanelsFilterHaveEveryContactOpenAndEveryKeyTurned) {
  const PanelFilter filter;
  for (const ContactFilter& contact : {filter.read, filter.estop_a, filter.estop_b, filter.bench})
    EXPECT_EQ(contact.closed_ticks, 0);
  for (const KeyFilter& key : {filter.arm, filter.reset}) {
    EXPECT_TRUE(key.turned);
    EXPECT_EQ(key.other_ticks, 0);
  }
}

TEST(Defaults, OfTheInterlockAndTheTissueMonitorAreEmpty) {
  const Interlock interlock;
  EXPECT_TRUE(are_zero(interlock.fed_by_supervisor, interlock.fed_by_driver, interlock.supervisor_us,
                       interlock.driver_us, TissueMonitor{}.mean_drive_mV));
}

}  // namespace
}  // namespace biopsy::safety
