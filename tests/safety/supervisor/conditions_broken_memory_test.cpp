// Values that no sound program would hold: a flipped bit, a plan that was never checked. Every function is
// total, and what it does not know allows nothing.
#include <gtest/gtest.h>

#include <limits>

#include "safety/gate.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

Situation healthy() {
  Situation input;
  input.evidence = {kAllHazards, true, true, false, 0, 8'000'000};
  return input;
}

TEST(BrokenMemory, AnEventThatTheTableDoesNotListChangesNothing) {
  verifies("R-47");
  EXPECT_EQ(next_mode(Mode::Lock, Event::Arm), Mode::Lock);
  EXPECT_EQ(next_mode(Mode::Trip, static_cast<Event>(200)), Mode::Trip);
}

TEST(BrokenMemory, AHazardWithoutAnEntryHasNoName) {
  verifies("R-47");
  EXPECT_EQ(name_of(static_cast<Hazard>(200)), "none");
}

TEST(HazardTable, LocksOnWhatOnlyAServiceCanMend) {
  verifies("R-01", "R-02");
  EXPECT_EQ(locking_hazards(), bit(Hazard::ResidualCharge) | bit(Hazard::NeedleNotBack));
}

TEST(BrokenMemory, AModeThatDoesNotExistEndsInLockWithAPermitThatAllowsNothing) {
  verifies("R-47");
  for (int mode = static_cast<int>(Mode::Lock) + 1; mode <= 255; ++mode) {
    SupervisorState state = started(1);
    state.mode = static_cast<Mode>(mode);
    const auto [next, output] = step(three_stage_plan(), state, healthy());
    EXPECT_EQ(next.mode, Mode::Lock);
    EXPECT_FALSE(output.permit.hv_enable);
    EXPECT_EQ(output.permit.stop, StopCategory::C0Off);
    EXPECT_EQ(output.permit.v_max_mV, 0);
  }
}

TEST(BrokenMemory, APlanWithoutStagesHasNoFurtherOne) {
  verifies("R-29");
  PlanFacts plan = three_stage_plan();
  plan.stage_count = 0;
  SupervisorState state = started(1);
  state.mode = Mode::Hold;
  state.stage_done = true;
  Situation input = healthy();
  input.motion = {5, true};
  const auto [next, output] = step(plan, state, input);
  EXPECT_EQ(next.mode, Mode::Hold);
  EXPECT_EQ(output.refusal, Refusal::PlanDone);
}

TEST(BrokenMemory, AStageBeyondTheRoomForStagesIsAllowedNothingWhateverThePlanCounts) {
  verifies("R-29");
  PlanFacts plan = three_stage_plan();
  plan.stage_count = std::numeric_limits<std::uint32_t>::max();
  plan.stages.fill(plan.stages[0]);
  SupervisorState state = started(1);
  state.mode = Mode::Active;
  for (const std::uint32_t stage : {std::uint32_t{kMaxSteps}, std::uint32_t{kMaxSteps} + 8}) {
    state.stage = stage;
    const Permit permit = step(plan, state, healthy()).second.permit;
    EXPECT_EQ(permit.v_max_mV, 0);
    EXPECT_EQ(permit.slew_up_mV_per_tick, 0);
  }
  state.stage = kMaxSteps - 1;
  EXPECT_GT(step(plan, state, healthy()).second.permit.v_max_mV, 0);
}

// A gate that drives under a permit that it honoured at 1 ms.
GateState driving() {
  GateState state;
  state.permit.session = 1;
  state.permit.seq = 1;
  state.permit.ttl_us = limits::kPermitTtl_us;
  state.permit.hv_enable = true;
  state.permit.mode = Mode::Active;
  state.permit.stop = StopCategory::None;
  state.permit.v_max_mV = state.permit.slew_up_mV_per_tick = 1'000;
  state.started = true;
  state.permit_us = state.now_us = 1'000;
  return state;
}

DriveRequest request() {
  return {.seq = 1, .wanted_mV = 1'000};
}

TEST(BrokenMemory, APermitHonouredAtATimeThatHasNotComeIsDead) {
  verifies("R-47");
  GateState state = driving();
  const DriveRequest request = biopsy::safety::request();
  state.permit_us = 2'000;
  EXPECT_TRUE(gate(state, &request, nullptr, 2'000, 1).voltage.hv_enabled()) << "honoured in this very tick";
  state.permit_us = 2'001;
  const GateResult result = gate(state, &request, nullptr, 2'000, 1);
  EXPECT_EQ(result.verdict, GateVerdict::Expired);
  EXPECT_FALSE(result.voltage.hv_enabled());
  EXPECT_EQ(result.voltage.mV(), 0);
}

TEST(BrokenMemory, APermitWithoutALifeIsDeadInItsOwnTick) {
  verifies("R-47");
  for (const std::int32_t ttl_us : {0, -1, std::numeric_limits<std::int32_t>::min()}) {
    GateState state = driving();
    state.permit.ttl_us = ttl_us;
    state.permit_us = 2'000;
    const DriveRequest wanted = request();
    EXPECT_EQ(gate(state, &wanted, nullptr, 2'000, 1).verdict, GateVerdict::Expired) << ttl_us;
  }
}

TEST(BrokenMemory, AClockThatComesFromAnywhereIsAJumpAndNothingWorse) {
  verifies("R-05", "R-47");
  constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
  for (const auto& [from_us, to_us] :
       {std::pair{kFirst, kLast}, {kLast, kFirst}, {kLast, kLast}, {kLast - 1, kFirst}}) {
    GateState state = driving();
    state.now_us = from_us;
    const DriveRequest wanted = request();
    EXPECT_EQ(gate(state, &wanted, nullptr, to_us, 1).verdict, GateVerdict::ClockJump)
        << from_us << " " << to_us;
  }
  GateState late = driving();
  late.now_us = late.permit_us = kLast - 1;
  const DriveRequest wanted = request();
  EXPECT_TRUE(gate(late, &wanted, nullptr, kLast, 1).voltage.hv_enabled())
      << "the last step of a clock is one";
}

TEST(BrokenMemory, AStopThatDoesNotExistIsTheStrongest) {
  verifies("R-36", "R-47");
  for (const Mode mode : {Mode::Armed, Mode::Active, Mode::Hold, Mode::Retract}) {
    SupervisorState state = started(1);
    state.mode = mode;
    Situation input = healthy();
    input.stop = static_cast<StopCategory>(200);
    EXPECT_EQ(step(three_stage_plan(), state, input).first.mode, Mode::Trip) << name_of(mode);
  }
}

TEST(BrokenMemory, TicksAndVoltagesOfAnotherWorldStillEndInAPermitOfThisOne) {
  verifies("R-47");
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  for (const Mode mode : {Mode::Active, Mode::Hold, Mode::Retract})
    for (const std::int32_t ticks : {kLeast, -1, kMost})
      for (const std::int32_t held_mV : {kLeast, -1, kMost}) {
        SupervisorState state = started(1);
        state.mode = mode;
        state.ticks_in_mode = state.ticks_since_held = ticks;
        state.held_mV = held_mV;
        Situation input = healthy();
        input.evidence.zero_volts = false;
        const Permit permit = step(three_stage_plan(), state, input).second.permit;
        EXPECT_GE(permit.v_max_mV, 0);
        EXPECT_LE(permit.v_max_mV, limits::kDriveMax_mV);
      }
}

}  // namespace
}  // namespace biopsy::safety
