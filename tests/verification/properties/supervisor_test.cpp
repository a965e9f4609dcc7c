// The supervisor's step and its evidence from any memory, under any plan: total, and never permissive.
#include "safety/supervisor.hpp"

#include "safety/monitors/tissue_monitor.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/verification/fuzz/safety_values.hpp"
#include "tests/verification/properties/property.hpp"

namespace biopsy::properties {
namespace {

using safety::bit;
using safety::Hazard;
using safety::kAllHazards;

bool is_real(Mode mode) {
  return mode <= Mode::Lock;
}

RC_GTEST_PROP(Supervisor, AllowsNothingBeyondTheRobotFromAnyMemory, ()) {
  verifies("R-35", "R-47");
  const auto bytes = any_bytes();
  fuzz::Feed feed(bytes);
  safety::PlanFacts plan;
  safety::SupervisorState state;
  safety::Situation input;
  fuzz::fill(feed, plan), fuzz::fill(feed, state), fuzz::fill(feed, input);
  if (*rc::gen::arbitrary<bool>()) state.mode = static_cast<Mode>(*rc::gen::inRange(0, 9));
  if (*rc::gen::arbitrary<bool>()) input.evidence.clear = kAllHazards;
  const auto [next, output] = safety::step(plan, state, input);
  const Permit& permit = output.permit;
  RC_ASSERT(permit.v_max_mV >= 0 && permit.v_max_mV <= limits::kDriveMax_mV);
  RC_ASSERT(permit.slew_up_mV_per_tick >= 0 && permit.slew_up_mV_per_tick <= limits::kSlewUpMax_mV_per_tick);
  RC_ASSERT(is_real(next.mode) && permit.hv_enable == safety::hv_permitted(next.mode));
  RC_ASSERT(permit.slew_up_mV_per_tick == 0 || next.mode == Mode::Active);
  RC_ASSERT(permit.seq == state.seq + 1);
}

RC_GTEST_PROP(Supervisor, OneHazardMoreNeverAllowsMoreFromAnyMemory, ()) {
  verifies("R-48");
  const auto bytes = any_bytes();
  fuzz::Feed feed(bytes);
  safety::SupervisorState state;
  safety::Situation input;
  fuzz::fill(feed, state), fuzz::fill(feed, input);
  state.mode = static_cast<Mode>(*rc::gen::inRange(0, 9));
  input.evidence.clear = kAllHazards;
  const safety::PlanFacts plan = safety::three_step_plan();
  const auto [next, output] = safety::step(plan, state, input);
  input.evidence.clear &= ~bit(static_cast<Hazard>(*rc::gen::inRange<std::size_t>(0, safety::kHazards)));
  const auto [worse_next, worse] = safety::step(plan, state, input);
  RC_ASSERT(safety::permissiveness(worse_next.mode) <= safety::permissiveness(next.mode));
  RC_ASSERT(worse.permit.slew_up_mV_per_tick <= output.permit.slew_up_mV_per_tick);
}

RC_GTEST_PROP(Supervisor, AStopThatDoesNotExistStopsAsTheStrongest, ()) {
  verifies("R-36", "R-47");
  safety::SupervisorState state = safety::started(1);
  state.mode = *rc::gen::element(Mode::Armed, Mode::Active, Mode::Hold, Mode::Retract);
  safety::Situation input;
  input.evidence = {kAllHazards, true, true, true, false, false, false, 0};
  input.stop = static_cast<StopCategory>(*rc::gen::inRange(3, 256));
  const auto [next, output] = safety::step(safety::three_step_plan(), state, input);
  RC_ASSERT(next.mode == Mode::Trip);
  RC_ASSERT(!output.permit.hv_enable);
}

// What one look at the outside says, said again by one look at the outside.
RC_GTEST_PROP(Evidence, IsWhatTheObservationSays, ()) {
  verifies("R-03", "R-11", "R-12", "R-13", "R-28", "R-33");
  const auto bytes = any_bytes();
  fuzz::Feed feed(bytes);
  const safety::PlanFacts plan = safety::three_step_plan();
  safety::EvidenceMemory memory;
  bool latched = false, reset_was_down = true;
  for (int tick = 0; tick < 8; ++tick) {
    safety::SupervisorInputs seen;
    fuzz::fill(feed, seen.measurement), fuzz::fill(feed, seen.request), fuzz::fill(feed, seen.permit);
    feed.fill(seen.now_us, seen.panel_read, seen.local_reset, seen.estop_a_closed, seen.estop_b_closed,
              seen.log_backlog_ms, seen.patient_motion_um);
    seen.writers = *rc::gen::element(0, 1, 1, 2);
    seen.plan_tag = *rc::gen::element(plan.plan_tag, std::uint64_t{0}, std::uint64_t{1});
    seen.config_tag = *rc::gen::element(plan.config_tag, std::uint64_t{0}, std::uint64_t{1});
    const safety::HazardSet clear = safety::assess(plan, memory, seen).clear;
    const auto is_clear = [clear](Hazard hazard) { return (clear & bit(hazard)) != 0; };
    const bool pressed = !seen.panel_read || !seen.estop_a_closed || !seen.estop_b_closed;
    latched = pressed || (latched && (!seen.local_reset || reset_was_down));
    reset_was_down = seen.local_reset;
    RC_ASSERT(is_clear(Hazard::EStop) == !latched);
    RC_ASSERT(is_clear(Hazard::SecondWriter) ==
              (seen.writers == 1 && seen.measurement.verdict != GateVerdict::SecondWriter));
    RC_ASSERT(is_clear(Hazard::PlanChanged) == (seen.plan_tag == plan.plan_tag));
    RC_ASSERT(is_clear(Hazard::ConfigChanged) == (seen.config_tag == plan.config_tag));
    RC_ASSERT(is_clear(Hazard::LogBacklog) == (seen.log_backlog_ms >= 0 && seen.log_backlog_ms <= 1'000));
    RC_ASSERT(is_clear(Hazard::PatientMotion) ==
              (seen.patient_motion_um >= 0 && seen.patient_motion_um <= 2'000));
  }
}

RC_GTEST_PROP(PlanFacts, APlausibleBandIsNeverEmptyAndGrowsWithTheWindow, ()) {
  verifies("R-21");
  const safety::PlanFacts plan = safety::three_step_plan();
  const auto drive = [] { return *rc::gen::inRange(0, limits::kMonitorTrip_mV + 1); };
  const std::int32_t a = drive(), b = drive(), low = std::min(a, b), high = std::max(a, b);
  const std::int32_t inside = *rc::gen::inRange(low, high + 1);
  const safety::DepthRange wide = safety::plausible_depth(plan, low, high);
  const safety::DepthRange narrow = safety::plausible_depth(plan, inside, inside);
  RC_ASSERT(narrow.low_um <= narrow.high_um);
  RC_ASSERT(wide.low_um <= narrow.low_um && narrow.high_um <= wide.high_um);
}

RC_GTEST_PROP(PlanFacts, AreJudgedAndUsedWhateverTheySay, ()) {
  verifies("R-29", "R-47");
  const auto bytes = any_bytes();
  fuzz::Feed feed(bytes);
  safety::PlanFacts plan;
  fuzz::fill(feed, plan);
  safety::TissueMonitor watch;
  Measurement measured;
  fuzz::fill(feed, measured);
  RC_ASSERT(safety::tissue_residual_um(plan, watch, measured) >= 0);
  RC_ASSERT(safety::half_period_ticks(plan) >= safety::kBenchHalfPeriodMin_ticks);
  if (!safety::is_plausible(plan)) return;
  RC_ASSERT(plan.depth_max_um <= limits::kStroke_um && plan.step_count > 0);
}

}  // namespace
}  // namespace biopsy::properties
