// What one step makes of one state, field by field.
#include <gtest/gtest.h>

#include "safety/challenge.hpp"
#include "safety/decide.hpp"
#include "safety/types/thresholds.hpp"
#include "tests/safety/situation.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

// An input that leaves the mode as it is.
Situation steady(Mode mode) {
  Situation input = healthy();
  if (mode == Mode::Safe) input.stop = StopCategory::C2Hold;
  if (mode == Mode::Boot || mode == Mode::Retract) input.evidence.zero_volts = false;
  return input;
}

std::pair<SupervisorState, SupervisorOutput> stays(Mode mode) {
  const auto result = step(three_step_plan(), in(mode), steady(mode));
  EXPECT_EQ(result.first.mode, mode);
  return result;
}

TEST(Supervisor, PermitsSayWhoseTheyAreAndWhatTheyAreFor) {
  const Permit permit = stays(Mode::Active).second.permit;
  EXPECT_EQ(permit.session, 3U);
  EXPECT_EQ(permit.epoch, 4U);
  EXPECT_EQ(permit.seq, 71U);
  EXPECT_EQ(permit.issued_us, 123'456);
  EXPECT_EQ(permit.ttl_us, 5'000);
  EXPECT_EQ(permit.mode, Mode::Active);
  EXPECT_EQ(permit.plan_tag, three_step_plan().plan_tag);
  EXPECT_EQ(permit.config_tag, three_step_plan().config_tag);
  EXPECT_EQ(permit.challenge, challenge_of(3, 71));
}

TEST(Supervisor, PermitsOfEachModeAllowWhatItsLineInTheTableOfStatesSays) {
  const PlanFacts plan = three_step_plan();
  struct Allowed {
    Mode mode;
    StopCategory stop;
    bool hv_enable;
    std::int32_t v_max_mV, slew_up_mV, depth_max_um;
  };
  const Allowed table[] = {
      {Mode::Boot, StopCategory::C0Off, false, 0, 0, 0},
      {Mode::Safe, StopCategory::C0Off, false, 0, 0, 0},
      {Mode::Ready, StopCategory::C0Off, false, 0, 0, 0},
      {Mode::Armed, StopCategory::C2Hold, true, 0, 0, 0},
      {Mode::Active, StopCategory::None, true, plan.steps[0].v_max_mV, plan.steps[0].slew_up_mV_per_tick,
       plan.steps[0].depth_max_um},
      {Mode::Hold, StopCategory::C2Hold, true, 5'000'000, 0, 0},
      {Mode::Retract, StopCategory::C1Ramp, true, 4'980'000, 0, 0},
      {Mode::Trip, StopCategory::C0Off, false, 0, 0, 0},
      {Mode::Lock, StopCategory::C0Off, false, 0, 0, 0},
  };
  for (const Allowed& allowed : table) {
    const Permit permit = stays(allowed.mode).second.permit;
    EXPECT_EQ(permit.stop, allowed.stop) << name_of(allowed.mode);
    EXPECT_EQ(permit.hv_enable, allowed.hv_enable) << name_of(allowed.mode);
    EXPECT_EQ(permit.v_max_mV, allowed.v_max_mV) << name_of(allowed.mode);
    EXPECT_EQ(permit.slew_up_mV_per_tick, allowed.slew_up_mV) << name_of(allowed.mode);
    EXPECT_EQ(permit.depth_max_um, allowed.depth_max_um) << name_of(allowed.mode);
  }
}

TEST(Supervisor, OutputsFeedTheInterlockAndAllowImagesInTheirModesOnly) {
  for (std::size_t i = 0; i < kModes; ++i) {
    const auto mode = static_cast<Mode>(i);
    const SupervisorOutput output = stays(mode).second;
    EXPECT_EQ(output.interlock_pulse, mode == Mode::Boot || mode == Mode::Ready || hv_permitted(mode))
        << name_of(mode);
    EXPECT_EQ(output.image_allowed, mode != Mode::Active && mode != Mode::Retract) << name_of(mode);
    EXPECT_FALSE(output.image_disturbed);
    EXPECT_EQ(output.event, Event::None) << name_of(mode);
  }
}

TEST(Supervisor, OutputsNameTheEventAndPassOnThatAnImageWasDisturbed) {
  Situation input = healthy();
  input.evidence.image_disturbed = true;
  input.stop = StopCategory::C1Ramp;
  const SupervisorOutput output = step(three_step_plan(), in(Mode::Active), input).second;
  EXPECT_EQ(output.event, Event::Ramp);
  EXPECT_TRUE(output.image_disturbed);
}

TEST(Supervisor, StepsBeyondTheCountOfThePlanAllowNothingThoughNumbersStandThere) {
  PlanFacts plan = three_step_plan();
  plan.step_count = 1;
  for (const std::uint32_t number : {1U, 2U}) {
    SupervisorState state = in(Mode::Active);
    state.step = number;
    EXPECT_EQ(step(plan, state, healthy()).second.permit.v_max_mV, 0) << number;
  }
}

TEST(Supervisor, StepsWithANegativeEnvelopeOrSlewAllowNone) {
  for (const std::int32_t value : {-1, 0}) {
    PlanFacts plan = three_step_plan();
    plan.steps[0].v_max_mV = plan.steps[0].slew_up_mV_per_tick = value;
    const Permit permit = step(plan, in(Mode::Active), healthy()).second.permit;
    EXPECT_EQ(permit.v_max_mV, 0);
    EXPECT_EQ(permit.slew_up_mV_per_tick, 0);
  }
}

TEST(Supervisor, StepsStartOverFromTheFirstAtEveryArming) {
  SupervisorState state = in(Mode::Ready);
  state.step = 2, state.step_done = true;
  Situation input = healthy();
  input.local_arm = true;
  const SupervisorState next = step(three_step_plan(), state, input).first;
  ASSERT_EQ(next.mode, Mode::Armed);
  EXPECT_EQ(next.step, 0U);
  EXPECT_FALSE(next.step_done);
}

TEST(Supervisor, ReasonsOutliveTheEndOfARampButNotAReset) {
  SupervisorState state = in(Mode::Retract);
  state.reason = Hazard::PopThrough;
  EXPECT_EQ(step(three_step_plan(), state, healthy()).first.reason, Hazard::PopThrough);
  state = in(Mode::Trip);
  state.reason = Hazard::Arc;
  Situation input = healthy();
  input.local_reset = true;
  const SupervisorState next = step(three_step_plan(), state, input).first;
  ASSERT_EQ(next.mode, Mode::Safe);
  EXPECT_EQ(next.reason, Hazard::None);
}

TEST(Supervisor, EpochsBeginWithATripOrALockAndWithNothingElse) {
  Situation input = healthy();
  input.evidence.clear &= ~bit(Hazard::ResidualCharge);
  EXPECT_EQ(step(three_step_plan(), in(Mode::Ready), input).first.epoch, 5U) << "ready to lock";
  EXPECT_EQ(step(three_step_plan(), in(Mode::Active), input).first.epoch, 5U) << "active to trip";
  EXPECT_EQ(step(three_step_plan(), in(Mode::Safe), healthy()).first.epoch, 4U) << "safe to ready";
  EXPECT_EQ(step(three_step_plan(), in(Mode::Boot), healthy()).first.epoch, 4U) << "boot to safe";
}

TEST(Supervisor, EnvelopesOfAHoldNeverBeginBelowZeroOrAboveTheStep) {
  std::int32_t ceiling_mV = 8'000'000;
  const auto held = [&](std::int32_t drive_mV) {
    Situation input = healthy();
    input.stop = StopCategory::C2Hold;
    input.evidence.drive_mV = drive_mV;
    input.evidence.ceiling_mV = ceiling_mV;
    return step(three_step_plan(), in(Mode::Active), input).second.permit.v_max_mV;
  };
  EXPECT_EQ(held(-5), 0);
  EXPECT_EQ(held(0), 0);
  EXPECT_EQ(held(1), 1);
  EXPECT_EQ(held(6'500'001), 6'500'000);
  ceiling_mV = 3'000'000;
  EXPECT_EQ(held(3'000'001), 3'000'000) << "a driver above its ceiling is not followed";
  ceiling_mV = -1;
  EXPECT_EQ(held(1), 0);
}

TEST(Supervisor, EnvelopesOfARampThatIsOverStayAtZero) {
  Situation input = healthy();
  input.evidence.zero_volts = false;
  for (const std::int32_t ticks : {kRamp_ms - 1, kRamp_ms, kRamp_ms + 40}) {
    SupervisorState state = in(Mode::Retract);
    state.ms_in_mode = ticks;
    EXPECT_EQ(step(three_step_plan(), state, input).second.permit.v_max_mV, 0) << ticks;
  }
}

TEST(Supervisor, HoldToRunAMessageWithoutATokenKeepsNothingAlive) {
  SupervisorState state = in(Mode::Active);
  state.token = 0, state.ms_since_held = 7;
  Situation input = healthy();
  input.motion = {0, true};
  EXPECT_EQ(step(three_step_plan(), state, input).first.ms_since_held, 8);
  state.token = 0xFFFF'FFFF;
  input.motion = {0xFFFF'FFFF, true};
  EXPECT_EQ(step(three_step_plan(), state, input).first.ms_since_held, 0);
}

TEST(Supervisor, RefusalsOfALockAreTheSameForEveryRequest) {
  const auto refusal = [](const Situation& input) {
    return step(three_step_plan(), in(Mode::Lock), input).second.refusal;
  };
  Situation press = healthy(), remote = healthy(), reset = healthy(), arm = healthy();
  press.motion = {11, true};
  remote.remote_arm = true;
  reset.local_reset = true;
  arm.local_arm = true;
  for (const Situation& input : {press, remote, reset, arm}) EXPECT_EQ(refusal(input), Refusal::Locked);
}

TEST(Permissiveness, RanksTheModesFromLockToActive) {
  const Mode rising[] = {Mode::Lock,  Mode::Trip, Mode::Boot,  Mode::Retract, Mode::Safe,
                         Mode::Ready, Mode::Hold, Mode::Armed, Mode::Active};
  int rank = 0;
  for (const Mode mode : rising) EXPECT_EQ(permissiveness(mode), rank++) << name_of(mode);
}

}  // namespace
}  // namespace biopsy::safety
