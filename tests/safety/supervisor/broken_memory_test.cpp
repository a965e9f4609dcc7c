// Values that no sound program would hold: every function is total, and what it does not know allows nothing.
#include <gtest/gtest.h>

#include <limits>

#include "safety/types/limits.hpp"
#include "tests/safety/situation.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

TEST(HazardTable, AnEventThatTheTableDoesNotListChangesNothing) {
  verifies("R-47");
  EXPECT_EQ(next_mode(Mode::Lock, Event::Arm), Mode::Lock);
  EXPECT_EQ(next_mode(Mode::Trip, static_cast<Event>(200)), Mode::Trip);
}

TEST(HazardTable, AHazardWithoutAnEntryHasNoName) {
  verifies("R-47");
  EXPECT_EQ(name_of(static_cast<Hazard>(200)), "none");
}

TEST(Supervisor, AModeThatDoesNotExistEndsInLockWithAPermitThatAllowsNothing) {
  verifies("R-47");
  for (int mode = static_cast<int>(Mode::Lock) + 1; mode <= 255; ++mode) {
    SupervisorState state = started(1);
    state.mode = static_cast<Mode>(mode);
    const auto [next, output] = step(three_step_plan(), state, healthy());
    EXPECT_EQ(next.mode, Mode::Lock);
    EXPECT_FALSE(output.permit.hv_enable);
    EXPECT_EQ(output.permit.stop, StopCategory::C0Off);
    EXPECT_EQ(output.permit.v_max_mV, 0);
  }
}

TEST(Supervisor, APlanWithoutStepsHasNoFurtherOne) {
  verifies("R-29");
  PlanFacts plan = three_step_plan();
  plan.step_count = 0;
  SupervisorState state = started(1);
  state.mode = Mode::Hold;
  state.step_done = true;
  Situation input = healthy();
  input.motion = {5, true};
  const auto [next, output] = step(plan, state, input);
  EXPECT_EQ(next.mode, Mode::Hold);
  EXPECT_EQ(output.refusal, Refusal::PlanDone);
}

TEST(Supervisor, AStepBeyondTheRoomForStepsIsAllowedNothingWhateverThePlanCounts) {
  verifies("R-29");
  PlanFacts plan = three_step_plan();
  plan.step_count = std::numeric_limits<std::uint32_t>::max();
  plan.steps.fill(plan.steps[0]);
  SupervisorState state = started(1);
  state.mode = Mode::Active;
  for (const std::uint32_t number : {std::uint32_t{kMaxSteps}, std::uint32_t{kMaxSteps} + 8}) {
    state.step = number;
    const Permit permit = step(plan, state, healthy()).second.permit;
    EXPECT_EQ(permit.v_max_mV, 0);
    EXPECT_EQ(permit.slew_up_mV_per_tick, 0);
  }
  state.step = kMaxSteps - 1;
  EXPECT_GT(step(plan, state, healthy()).second.permit.v_max_mV, 0);
}

TEST(Supervisor, AStopThatDoesNotExistIsTheStrongest) {
  verifies("R-36", "R-47");
  for (const Mode mode : {Mode::Armed, Mode::Active, Mode::Hold, Mode::Retract}) {
    SupervisorState state = started(1);
    state.mode = mode;
    Situation input = healthy();
    input.stop = static_cast<StopCategory>(200);
    EXPECT_EQ(step(three_step_plan(), state, input).first.mode, Mode::Trip) << name_of(mode);
  }
}

TEST(Supervisor, TicksAndVoltagesOfAnotherWorldStillEndInAPermitOfThisOne) {
  verifies("R-47");
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  for (const Mode mode : {Mode::Active, Mode::Hold, Mode::Retract})
    for (const std::int32_t ticks : {kLeast, -1, kMost})
      for (const std::int32_t held_mV : {kLeast, -1, kMost}) {
        SupervisorState state = started(1);
        state.mode = mode;
        state.ms_in_mode = state.ms_since_held = ticks;
        state.held_mV = held_mV;
        Situation input = healthy();
        input.evidence.zero_volts = false;
        const Permit permit = step(three_step_plan(), state, input).second.permit;
        EXPECT_GE(permit.v_max_mV, 0);
        EXPECT_LE(permit.v_max_mV, limits::kDriveMax_mV);
      }
}

}  // namespace
}  // namespace biopsy::safety
