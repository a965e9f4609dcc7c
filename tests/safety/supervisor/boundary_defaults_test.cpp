// Absence means no: what nobody filled in proves nothing, allows nothing and has seen nothing.
#include <gtest/gtest.h>

#include <limits>

#include "safety/gate.hpp"
#include "safety/interlock.hpp"
#include "safety/monitors/evidence.hpp"
#include "safety/monitors/tissue_monitor.hpp"
#include "safety/supervisor.hpp"
#include "tests/safety/situation.hpp"

namespace biopsy::safety {
namespace {

constexpr std::int32_t kUnknown = std::numeric_limits<std::int32_t>::max();

TEST(Absence, AnObservationSawNothing) {
  const SupervisorInputs seen;
  EXPECT_EQ(seen.now_us, 0);
  EXPECT_EQ(seen.writers, 0);
  EXPECT_FALSE(seen.estop_a_closed);
  EXPECT_FALSE(seen.estop_b_closed);
  EXPECT_TRUE(seen.acquiring);
  EXPECT_EQ(seen.log_backlog_ms, kUnknown);
  EXPECT_EQ(seen.patient_motion_um, kUnknown);
  EXPECT_EQ(seen.tissue_residual_um, kUnknown);
  EXPECT_EQ(seen.plan_tag, 0U);
  EXPECT_EQ(seen.config_tag, 0U);
  EXPECT_FALSE(seen.bench_confirmed);
}

TEST(Absence, EvidenceProvesNothing) {
  const Evidence evidence;
  EXPECT_EQ(evidence.clear, 0U);
  EXPECT_FALSE(evidence.zero_volts);
  EXPECT_FALSE(evidence.needle_home);
  EXPECT_TRUE(evidence.image_disturbed);
  EXPECT_EQ(evidence.drive_mV, 0);
}

TEST(Absence, AnInputAsksForNothingAndHasPassedNoTest) {
  const Situation input;
  EXPECT_EQ(input.now_us, 0);
  EXPECT_EQ(input.self_test, SelfTest::Pending);
  EXPECT_FALSE(input.local_arm || input.local_reset || input.remote_arm || input.remote_reset);
  EXPECT_EQ(input.stop, StopCategory::None);
  EXPECT_EQ(input.motion.token, 0U);
  EXPECT_FALSE(input.motion.held);
  EXPECT_FALSE(input.depth_accepted);
  EXPECT_EQ(input.accepted_stage, 0U);
}

TEST(Absence, ASupervisorStartsInBootWithBothKeysTakenAsHeld) {
  const SupervisorState state;
  EXPECT_EQ(state.mode, Mode::Boot);
  EXPECT_EQ(state.last_event, Event::None);
  EXPECT_EQ(state.reason, Hazard::None);
  EXPECT_FALSE(state.stage_done);
  EXPECT_TRUE(state.arm_was_down && state.reset_was_down);
  EXPECT_EQ(state.session, 0U);
  EXPECT_EQ(state.epoch, 1U);
  EXPECT_EQ(state.seq, 0U);
  EXPECT_EQ(state.token, 0U);
  EXPECT_EQ(state.stage, 0U);
  EXPECT_EQ(state.ticks_in_mode, 0);
  EXPECT_EQ(state.ticks_since_held, 0);
  EXPECT_EQ(state.held_mV, 0);
  EXPECT_EQ(started(6).session, 6U);
}

TEST(Absence, AnOutputAllowsNothing) {
  const SupervisorOutput output;
  EXPECT_EQ(output.event, Event::None);
  EXPECT_EQ(output.worst, Hazard::None);
  EXPECT_EQ(output.reason, Hazard::None);
  EXPECT_EQ(output.refusal, Refusal::Locked);
  EXPECT_EQ(output.stage, 0U);
  EXPECT_FALSE(output.stage_done);
  EXPECT_FALSE(output.image_allowed);
  EXPECT_TRUE(output.image_disturbed);
  EXPECT_FALSE(output.interlock_pulse);
}

TEST(Absence, AGateIsOffAndBoundToNobody) {
  const GateState state;
  EXPECT_EQ(state.permit_us, 0);
  EXPECT_EQ(state.now_us, 0);
  EXPECT_EQ(state.request_seq, 0U);
  EXPECT_EQ(state.drive_mV, 0);
  EXPECT_FALSE(state.enabled);
  EXPECT_FALSE(state.started);
  EXPECT_EQ(state.latched, GateVerdict::Granted);
  const GateResult result{state};
  EXPECT_EQ(result.verdict, GateVerdict::Refused);
  EXPECT_EQ(result.answer, 0U);
  EXPECT_EQ(result.answered_seq, 0U);
  EXPECT_EQ(result.voltage.mV(), 0);
}

TEST(Absence, APlanPlansNothing) {
  const PlanFacts plan;
  EXPECT_EQ(plan.plan_tag, 0U);
  EXPECT_EQ(plan.config_tag, 0U);
  EXPECT_EQ(plan.depth_max_um, 0);
  EXPECT_EQ(plan.tissue_residual_max_um, 0);
  EXPECT_EQ(plan.bench_half_period_ticks, 0);
  EXPECT_EQ(plan.stage_count, 0U);
  EXPECT_EQ(plan.band_count, 0U);
  const StepLimits stage;
  EXPECT_EQ(stage.depth_max_um, 0);
  EXPECT_EQ(stage.v_max_mV, 0);
  EXPECT_EQ(stage.slew_up_mV_per_tick, 0);
  EXPECT_TRUE(stage.image_confirms);
  const PlausibleBand band;
  EXPECT_EQ(band.drive_mV, 0);
  EXPECT_EQ(band.low_um, 0);
  EXPECT_EQ(band.high_um, 0);
  const DepthRange range;
  EXPECT_EQ(range.low_um, 0);
  EXPECT_EQ(range.high_um, 0);
}

TEST(Absence, TheWatchOverTheLinksTakesAllForSilentAndNothingForProven) {
  const LinkMonitor watch;
  EXPECT_FALSE(watch.clock_read);
  EXPECT_EQ(watch.now_us, 0);
  EXPECT_EQ(watch.seq, 0U);
  EXPECT_EQ(watch.stage_us, 0);
  EXPECT_EQ(watch.stale_ticks, 4);
  EXPECT_EQ(watch.order_score, 0);
  EXPECT_EQ(watch.answered_seq, 0U);
  EXPECT_EQ(watch.answer_score, 4);
  EXPECT_EQ(watch.request_seq, 0U);
  EXPECT_EQ(watch.silent_ticks, 4);
  EXPECT_EQ(watch.overruns, 0U);
  EXPECT_EQ(watch.miss_score, 0);
  EXPECT_EQ(watch.estop_differs_ticks, 0);
  EXPECT_FALSE(watch.estop_latched);
  EXPECT_EQ(watch.residual_ticks, 0);
  EXPECT_FALSE(watch.plan_plausible);
  const LinkFindings findings;
  EXPECT_EQ(findings.found, 0U);
  EXPECT_FALSE(findings.fresh);
}

TEST(Absence, TheWatchOverTheDriveHasSeenNoZeroVolts) {
  const VoltageMonitor watch;
  EXPECT_EQ(watch.found, 0U);
  EXPECT_EQ(watch.command_mV, 0);
  EXPECT_EQ(watch.over_ticks + watch.arc_ticks + watch.disagree_ticks + watch.disobey_ticks, 0);
  EXPECT_EQ(watch.over_ticks, watch.arc_ticks);
  EXPECT_EQ(watch.disagree_ticks, watch.disobey_ticks);
  EXPECT_EQ(watch.zero_ticks, 0);
  EXPECT_EQ(watch.nonzero_ticks, 0);
  EXPECT_FALSE(watch.zero_volts);
  EXPECT_EQ(watch.off_ticks, 0);
  EXPECT_EQ(watch.signed_mVms, 0);
  EXPECT_EQ(watch.total_mVms, 0);
  EXPECT_EQ(watch.wave_ticks, 0);
  EXPECT_EQ(watch.flips, 0);
  EXPECT_EQ(watch.tick, 0);
  EXPECT_EQ(watch.polarity, 0);
  EXPECT_FALSE(watch.wrong_frequency);
  EXPECT_EQ(watch.pull_V2, 0);
  EXPECT_EQ(watch.ceiling_mV, 0);
  const DriveFindings findings;
  EXPECT_EQ(findings.found, 0U);
  EXPECT_FALSE(findings.zero_volts);
  EXPECT_TRUE(findings.image_disturbed);
  EXPECT_EQ(findings.drive_mV, 0);
  EXPECT_EQ(findings.ceiling_mV, 0) << "no rise";
}

TEST(Absence, TheWatchOverTheDepthHasSeenNoTargetAndNoNeedleAtHome) {
  const DepthMonitor watch;
  EXPECT_EQ(watch.found, 0U);
  EXPECT_FALSE(watch.needle_home);
  EXPECT_EQ(watch.history.next, 0U);
  EXPECT_EQ(watch.history.newest, 0);
  EXPECT_EQ(watch.history.before, 0);
  EXPECT_EQ(watch.window.block, 0);
  EXPECT_EQ(watch.window.ticks, 0);
  EXPECT_EQ(watch.window.past_low_mV, 0);
  EXPECT_EQ(watch.window.past_high_mV, 0);
  EXPECT_EQ(watch.range_low_mV, -1) << "no drive: the range is looked up at the first";
  EXPECT_EQ(watch.range_high_mV, -1);
  EXPECT_EQ(watch.range_tag, 0U);
  EXPECT_EQ(watch.deepest_um, 0);
  EXPECT_EQ(watch.sunk_ticks, 0);
  EXPECT_EQ(watch.dropout_ticks, 3);
  for (const std::int32_t ticks : {watch.over_ticks, watch.hard_ticks, watch.stage_ticks, watch.pop_ticks,
                                   watch.implausible_ticks, watch.not_back_ticks, watch.same_code_ticks})
    EXPECT_EQ(ticks, 0);
  EXPECT_EQ(watch.code, 0);
  EXPECT_EQ(watch.frozen_low_mV, 0);
  EXPECT_EQ(watch.frozen_high_mV, 0);
  const DepthFindings findings;
  EXPECT_EQ(findings.found, 0U);
  EXPECT_FALSE(findings.needle_home);
}

TEST(Absence, NobodyHasFedTheInterlock) {
  const Interlock interlock;
  EXPECT_FALSE(interlock.fed_by_supervisor);
  EXPECT_FALSE(interlock.fed_by_driver);
  EXPECT_EQ(interlock.supervisor_us, 0);
  EXPECT_EQ(interlock.driver_us, 0);
  EXPECT_EQ(TissueMonitor{}.mean_drive_mV, 0);
}

}  // namespace
}  // namespace biopsy::safety
