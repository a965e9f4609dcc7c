// Mode by mode: what leads out of each, what does not, and the reason given.
#include <gtest/gtest.h>

#include <set>

#include "safety/types/limits.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/situation.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

constexpr Mode kAllModes[] = {Mode::Boot, Mode::Safe,    Mode::Ready, Mode::Armed, Mode::Active,
                              Mode::Hold, Mode::Retract, Mode::Trip,  Mode::Lock};

Mode after(const SupervisorState& state, const Situation& input) {
  return step(three_step_plan(), state, input).first.mode;
}

TEST(Supervisor, ReachesEveryMode) {
  for (const Mode mode : kAllModes) {
    Rig rig;
    EXPECT_TRUE(rig.go_to(mode)) << name_of(mode);
  }
}

TEST(Supervisor, RefusesEverythingFromADefaultInput) {
  verifies("R-47");
  for (const Mode mode : kAllModes) {
    const auto [next, output] = step(PlanFacts{}, in(mode), Situation{});
    EXPECT_FALSE(output.permit.hv_enable) << name_of(mode);
    EXPECT_EQ(output.permit.v_max_mV, 0);
    EXPECT_EQ(output.permit.slew_up_mV_per_tick, 0);
    EXPECT_EQ(output.permit.stop, StopCategory::C0Off);
    EXPECT_LE(permissiveness(next.mode), permissiveness(mode));
  }
}

TEST(Supervisor, C0DisablesInTheSameTickFromEveryHotModeAndStartsANewEpoch) {
  verifies("R-36");
  for (const Mode mode : {Mode::Armed, Mode::Active, Mode::Hold, Mode::Retract}) {
    Situation input = healthy();
    input.evidence.clear &= ~bit(Hazard::Arc);
    const auto [next, output] = step(three_step_plan(), in(mode), input);
    EXPECT_EQ(next.mode, Mode::Trip) << name_of(mode);
    EXPECT_EQ(next.epoch, in(mode).epoch + 1);
    EXPECT_EQ(next.reason, Hazard::Arc);
    EXPECT_FALSE(output.permit.hv_enable);
    EXPECT_FALSE(output.interlock_pulse);
  }
}

TEST(Supervisor, LeavesBootOnlyWithSelfTestAndZeroVolts) {
  verifies("R-51");
  Situation input = healthy();
  EXPECT_EQ(after(in(Mode::Boot), input), Mode::Safe);
  input.evidence.zero_volts = false;
  EXPECT_EQ(after(in(Mode::Boot), input), Mode::Boot);
  input = healthy();
  input.self_test = SelfTest::Pending;
  EXPECT_EQ(after(in(Mode::Boot), input), Mode::Boot);
  input.self_test = SelfTest::Failed;
  EXPECT_EQ(after(in(Mode::Boot), input), Mode::Lock);
}

TEST(Supervisor, TripsOnVoltageWhereThereMustBeNone) {
  Situation input = healthy();
  input.evidence.zero_volts = false;
  for (const Mode mode : {Mode::Safe, Mode::Ready, Mode::Armed})
    EXPECT_EQ(after(in(mode), input), Mode::Trip);
}

TEST(Supervisor, LocksOnResidualChargeFromEveryColdMode) {
  verifies("R-01", "R-51");
  for (const Mode mode : {Mode::Boot, Mode::Safe, Mode::Ready, Mode::Trip}) {
    Situation input = healthy();
    input.evidence.clear &= ~bit(Hazard::ResidualCharge);
    EXPECT_EQ(after(in(mode), input), Mode::Lock) << name_of(mode);
  }
}

// Friction of guide and tissue may hold it: somebody withdraws it by hand, and the robot is ready again.
TEST(Supervisor, IsNotReadyWhileTheNeedleStaysOut) {
  verifies("R-02");
  Situation out = healthy();
  out.evidence.clear &= ~bit(Hazard::NeedleNotBack);
  out.evidence.needle_home = false;
  EXPECT_EQ(after(in(Mode::Ready), out), Mode::Safe);
  EXPECT_EQ(after(in(Mode::Safe), out), Mode::Safe);
  out.local_arm = out.local_reset = true;
  EXPECT_EQ(after(in(Mode::Ready), out), Mode::Safe);
  EXPECT_EQ(after(in(Mode::Trip), out), Mode::Trip);
  EXPECT_EQ(after(in(Mode::Safe), healthy()), Mode::Ready);
}

TEST(Supervisor, ArmsOnAnEdgeOfTheLocalKeyOnly) {
  verifies("R-40");
  Situation input = healthy();
  input.remote_arm = true;
  auto [next, output] = step(three_step_plan(), in(Mode::Ready), input);
  EXPECT_EQ(next.mode, Mode::Ready);
  EXPECT_EQ(output.refusal, Refusal::OnlyLocal);
  input.remote_arm = false;
  input.local_arm = true;
  SupervisorState held_down = in(Mode::Ready);
  held_down.arm_was_down = true;
  EXPECT_EQ(after(held_down, input), Mode::Ready);
  EXPECT_EQ(after(in(Mode::Ready), input), Mode::Armed);
}

TEST(Supervisor, SaysWhyArmingIsRefused) {
  Situation input = healthy();
  input.local_arm = true;
  EXPECT_EQ(step(three_step_plan(), in(Mode::Hold), input).second.refusal, Refusal::NotReady);
  input.evidence.clear = 0;
  EXPECT_EQ(step(three_step_plan(), in(Mode::Safe), input).second.refusal, Refusal::Unhealthy);
  EXPECT_EQ(step(three_step_plan(), in(Mode::Lock), input).second.refusal, Refusal::Locked);
}

TEST(Supervisor, StopsOfEachCategoryLeaveArmedAndReady) {
  Situation input = healthy();
  input.stop = StopCategory::C2Hold;
  EXPECT_EQ(after(in(Mode::Ready), input), Mode::Safe);
  EXPECT_EQ(after(in(Mode::Armed), input), Mode::Ready);
  EXPECT_EQ(after(in(Mode::Safe), input), Mode::Safe);
  input.stop = StopCategory::C1Ramp;
  EXPECT_EQ(after(in(Mode::Armed), input), Mode::Ready);
}

TEST(Supervisor, ForgetsAnArmingThatNobodyUsesAfterThirtySeconds) {
  verifies("R-40");
  Rig rig;
  ASSERT_TRUE(rig.go_armed());
  EXPECT_EQ(rig.ticks_until([&] { return rig.state.mode != Mode::Armed; }, 40'000), limits::kArmedMax_ms);
  EXPECT_EQ(rig.state.mode, Mode::Ready);
}

TEST(Supervisor, HoldEndsInRetractAfterTenSecondsWithoutEverRising) {
  verifies("R-38");
  Rig rig;
  ASSERT_TRUE(rig.go_hold());
  std::int32_t highest = std::abs(rig.gate_state.drive_mV);
  const int ticks = rig.ticks_until(
      [&] {
        EXPECT_LE(std::abs(rig.gate_state.drive_mV), highest);
        highest = std::abs(rig.gate_state.drive_mV);
        return rig.state.mode != Mode::Hold;
      },
      20'000);
  EXPECT_EQ(ticks, limits::kHoldMax_ms);
  EXPECT_EQ(rig.state.mode, Mode::Retract);
  EXPECT_EQ(rig.state.last_event, Event::HoldTooLong);
}

TEST(Supervisor, RetractReachesZeroVoltsWithinThreeHundredMilliseconds) {
  verifies("R-37");
  Rig rig;
  ASSERT_TRUE(rig.go_retract());
  EXPECT_LT(rig.ticks_until([&] { return rig.state.mode != Mode::Retract; }, 1'000), limits::kRampTime_ms);
  EXPECT_EQ(rig.state.mode, Mode::Safe);
  EXPECT_LE(std::abs(rig.gate_state.drive_mV), limits::kZeroVolt_mV);
}

TEST(Supervisor, LeavesTripOnlyOnALocalResetEdgeWithEverythingBackToNormal) {
  verifies("R-39");
  Situation good = healthy();
  good.local_reset = true;
  EXPECT_EQ(after(in(Mode::Trip), good), Mode::Safe);
  SupervisorState held_down = in(Mode::Trip);
  held_down.reset_was_down = true;
  EXPECT_EQ(after(held_down, good), Mode::Trip);

  const auto refusal = [](const Situation& input) {
    const auto [next, output] = step(three_step_plan(), in(Mode::Trip), input);
    EXPECT_EQ(next.mode, Mode::Trip);
    return output.refusal;
  };
  Situation input = good;
  input.evidence.zero_volts = false;
  EXPECT_EQ(refusal(input), Refusal::VoltageLeft);
  input = good;
  input.evidence.needle_home = false;
  EXPECT_EQ(refusal(input), Refusal::NeedleOut);
  input = good;
  input.evidence.clear &= ~bit(Hazard::EStop);
  EXPECT_EQ(refusal(input), Refusal::Unhealthy);
  input = good;
  input.stop = StopCategory::C2Hold;
  EXPECT_EQ(refusal(input), Refusal::Unhealthy);
  input = healthy();
  input.remote_reset = true;
  EXPECT_EQ(refusal(input), Refusal::OnlyLocal);
}

TEST(Supervisor, AResetKeyHeldSinceBeforeTheTripDoesNotResetIt) {
  verifies("R-39");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.reset = true;
  rig.tick();
  EXPECT_EQ(rig.output.refusal, Refusal::NotTripped);
  rig.stop = StopCategory::C0Off;
  rig.tick();
  rig.stop = StopCategory::None;
  rig.release();
  rig.run(400);
  EXPECT_EQ(rig.state.mode, Mode::Trip);
  rig.reset = false;
  rig.tick();
  rig.reset = true;
  rig.tick();
  EXPECT_EQ(rig.state.mode, Mode::Safe);
}

TEST(Supervisor, TheReasonOfATripStaysUntilItIsReset) {
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.writers = 2;
  rig.tick();
  rig.writers = 1;
  rig.run(300);
  EXPECT_EQ(rig.state.mode, Mode::Trip);
  EXPECT_EQ(rig.output.reason, Hazard::SecondWriter);
  EXPECT_EQ(rig.output.worst, Hazard::None);
}

// Without a plan that is always a hazard, but it has nothing to do with a voltage.
TEST(Supervisor, AVoltageThatNobodyMeasuresIsBlamedOnTheMissingMeasurement) {
  Situation input = healthy();
  input.evidence.zero_volts = false;
  input.evidence.clear &= ~(bit(Hazard::PlanChanged) | bit(Hazard::SensorStale));
  for (const Mode mode : {Mode::Safe, Mode::Ready}) {
    const SupervisorState next = step(three_step_plan(), in(mode), input).first;
    EXPECT_EQ(next.mode, Mode::Trip) << name_of(mode);
    EXPECT_EQ(next.reason, Hazard::SensorStale) << name_of(mode);
  }
  input.evidence.clear |= bit(Hazard::SensorStale);
  EXPECT_EQ(step(three_step_plan(), in(Mode::Safe), input).first.reason, Hazard::PlanChanged);
}

TEST(Supervisor, AStopIsBlamedOnTheWorstThatIsFound) {
  Situation input = healthy();
  input.evidence.clear &= ~(bit(Hazard::PlanChanged) | bit(Hazard::SensorStale));
  const SupervisorState next = step(three_step_plan(), in(Mode::Active), input).first;
  EXPECT_EQ(next.last_event, Event::Fault);
  EXPECT_EQ(next.reason, Hazard::PlanChanged);
}

TEST(Supervisor, LockAbsorbsEveryHealthyInput) {
  verifies("R-51");
  Situation input = healthy();
  input.local_reset = input.local_arm = true;
  input.motion = {99, true};
  EXPECT_EQ(after(in(Mode::Lock), input), Mode::Lock);
}

TEST(Supervisor, AKeyOrAPressInTheTickThatEndsTheModeIsAnswered) {
  verifies("R-47");
  Rig ready;
  ASSERT_TRUE(ready.go_ready());
  ready.on_input = [](Situation& input) { input.evidence.zero_volts = false; };
  ready.arm = true;
  ready.tick();
  EXPECT_EQ(ready.state.mode, Mode::Trip);
  EXPECT_EQ(ready.output.refusal, Refusal::VoltageLeft);
  Rig holding;
  ASSERT_TRUE(holding.go_hold());
  holding.on_input = [](Situation& input) { input.request.finished = true; };
  holding.press();
  holding.tick();
  EXPECT_EQ(holding.state.mode, Mode::Retract);
  EXPECT_EQ(holding.output.refusal, Refusal::NotArmed);
}

TEST(Supervisor, RefusesNothingWhereNothingWasAsked) {
  for (const Mode mode : kAllModes)
    EXPECT_EQ(step(three_step_plan(), in(mode), healthy()).second.refusal, Refusal::None) << name_of(mode);
}

TEST(Supervisor, EveryNameIsKnownToPeople) {
  std::set<std::string_view> names;
  for (const Mode mode : kAllModes) names.insert(name_of(mode));
  for (std::size_t event = 0; event < kEvents; ++event) names.insert(name_of(static_cast<Event>(event)));
  for (const HazardFacts& facts : kHazardTable) names.insert(name_of(facts.hazard));
  EXPECT_EQ(names.size(), kModes + kEvents + kHazards);
  EXPECT_EQ(name_of(static_cast<Mode>(77)), "unknown mode");
  EXPECT_EQ(name_of(static_cast<Event>(77)), "unknown event");
  EXPECT_EQ(name_of(static_cast<Refusal>(77)), "unknown refusal");
  EXPECT_EQ(name_of(Hazard::None), "none");
  std::set<std::string_view> refusals;
  for (int refusal = 0; refusal <= static_cast<int>(Refusal::PlanDone); ++refusal)
    refusals.insert(name_of(static_cast<Refusal>(refusal)));
  EXPECT_EQ(refusals.size(), 12U);
  names.insert(refusals.begin(), refusals.end());
  for (const std::string_view name : names) EXPECT_GT(name.size(), 3U) << name;
}

// The reset key releases the emergency stop as well: where it did, it was followed; of a trip the refusal
// counts.
TEST(Supervisor, AResetKeyThatReleasesTheEmergencyStopIsNotRefusedOutsideATrip) {
  for (const bool releases : {false, true}) {
    Moment safe(Mode::Safe), trip(Mode::Trip);
    safe.input.local_reset = trip.input.local_reset = true;
    safe.input.evidence.estop_reset = trip.input.evidence.estop_reset = releases;
    safe.input.evidence.needle_back = false;
    trip.input.evidence.needle_home = false;
    EXPECT_EQ(safe.refusal(), releases ? Refusal::None : Refusal::NotTripped);
    EXPECT_EQ(trip.refusal(), Refusal::NeedleOut);
  }
}

}  // namespace
}  // namespace biopsy::safety
