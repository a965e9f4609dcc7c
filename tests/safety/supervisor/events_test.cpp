// The event of a step and the answer to a request, at the edges of times, tokens and steps.
#include <gtest/gtest.h>

#include "safety/types/limits.hpp"
#include "safety/types/thresholds.hpp"
#include "tests/safety/situation.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

TEST(Supervisor, EventsOfReadyTellALossOfHealthFromAStopThatWasAsked) {
  verifies("R-33");
  Moment moved(Mode::Ready), asked(Mode::Ready);
  moved.input.evidence.clear &= ~bit(Hazard::PatientMotion);
  asked.input.stop = StopCategory::C2Hold;
  EXPECT_EQ(moved.event(), Event::Unhealthy);
  EXPECT_EQ(asked.event(), Event::Stop);
}

TEST(Supervisor, EventsOfAnImmediateStopAndOfARampAreNamedAsSuchWhereverTheDriveMayBeOn) {
  for (const Mode mode : {Mode::Armed, Mode::Active, Mode::Hold, Mode::Retract}) {
    Moment moment(mode);
    moment.input.stop = StopCategory::C0Off;
    EXPECT_EQ(moment.event(), Event::Fault) << name_of(mode);
    moment.input.stop = StopCategory::C1Ramp;
    EXPECT_EQ(moment.event(), mode == Mode::Retract ? Event::None : Event::Ramp) << name_of(mode);
  }
  EXPECT_EQ(Moment(static_cast<Mode>(9)).event(), Event::Fault) << "a mode that does not exist";
}

TEST(Supervisor, EventsOfAControllerThatIsDoneEndTheMotionAndTheHold) {
  for (const Mode mode : {Mode::Active, Mode::Hold}) {
    Moment moment(mode);
    moment.input.request.finished = true;
    EXPECT_EQ(moment.event(), Event::Finished) << name_of(mode);
    EXPECT_EQ(moment.mode(), Mode::Retract) << name_of(mode);
  }
}

TEST(Supervisor, EventsOfTimesThatRanOutComeInTheVeryTickAndStillIfItWasMissed) {
  struct Limit {
    Mode mode;
    std::int32_t ticks;
    Event event;
  };
  for (const Limit& limit : {Limit{Mode::Boot, kBootMax_ms, Event::Lockout},
                             Limit{Mode::Armed, limits::kArmedMax_ms, Event::ArmedTooLong},
                             Limit{Mode::Hold, limits::kHoldMax_ms, Event::HoldTooLong},
                             Limit{Mode::Retract, limits::kRampTime_ms, Event::RampTooLong}}) {
    Moment moment(limit.mode);
    moment.input.self_test = SelfTest::Pending;
    for (const std::int32_t late : {-1, 0, 1, 5}) {
      moment.state.ms_in_mode = limit.ticks - 1 + late;  // this tick is one more
      EXPECT_EQ(moment.event(), late < 0 ? Event::None : limit.event) << name_of(limit.mode) << ' ' << late;
    }
  }
}

TEST(Supervisor, EventsThatChangeTheModeStartItsTimeAtZero) {
  for (const Mode mode : {Mode::Ready, Mode::Active, Mode::Hold}) {
    Moment moment(mode);
    moment.state.ms_in_mode = 700;
    EXPECT_EQ(moment.next().ms_in_mode, 701) << name_of(mode);
    moment.input.stop = StopCategory::C0Off;
    EXPECT_NE(moment.mode(), mode);
    EXPECT_EQ(moment.next().ms_in_mode, 0) << name_of(mode);
  }
}

TEST(Supervisor, HoldToRunEndsAfterAHundredTicksOfSilence) {
  for (const std::int32_t ticks : {99, 100, 101}) {
    Moment moment(Mode::Active);
    moment.state.ms_since_held = ticks;
    EXPECT_EQ(moment.event(), ticks < 100 ? Event::None : Event::Stop) << ticks;
  }
}

TEST(Supervisor, HoldToRunCountsTheTicksSinceAButtonThatIsNewEnoughWasHeldUpToItsLimit) {
  const auto ticks = [](std::int32_t before, std::uint32_t token, bool held) {
    Moment moment(Mode::Armed, token, held);
    moment.state.ms_since_held = before;
    return moment.next().ms_since_held;
  };
  EXPECT_EQ(ticks(7, 9, true), 8);
  EXPECT_EQ(ticks(7, 10, true), 0);
  EXPECT_EQ(ticks(7, 11, true), 0);
  EXPECT_EQ(ticks(7, 10, false), 8);
  EXPECT_EQ(ticks(99, 10, false), 100);
  EXPECT_EQ(ticks(100, 10, false), 100);
}

TEST(Supervisor, HoldToRunEndsWithItsOwnButtonOrANewerOneAndNotWithAnOlderOne) {
  EXPECT_EQ(Moment(Mode::Active, 9, false).event(), Event::None);
  EXPECT_EQ(Moment(Mode::Active, 9, true).event(), Event::None);
  EXPECT_EQ(Moment(Mode::Active, 10, true).event(), Event::None);
  EXPECT_EQ(Moment(Mode::Active, 10, false).event(), Event::Stop);
  EXPECT_EQ(Moment(Mode::Active, 11, false).event(), Event::Stop);
  EXPECT_EQ(Moment(Mode::Active, 11, true).event(), Event::Stop);
}

TEST(Supervisor, HoldToRunBeginsWithATokenNeverSeenBefore) {
  for (const std::uint32_t token : {9U, 10U, 11U}) {
    const Moment press(Mode::Armed, token, true);
    EXPECT_EQ(press.event(), token == 11 ? Event::Move : Event::None) << token;
    EXPECT_EQ(press.refusal(), token == 11 ? Refusal::None : Refusal::TokenSpent) << token;
  }
}

TEST(Supervisor, HoldRemembersNoVoltageBelowZero) {
  Moment moment(Mode::Active);
  moment.input.stop = StopCategory::C2Hold;
  moment.input.evidence.drive_mV = -5;
  EXPECT_EQ(moment.next().held_mV, 0);
}

TEST(Supervisor, StepsAreReachedByTheRequestForTheOneInForceOnly) {
  for (const std::uint32_t step : {0U, 1U, 2U}) {
    Moment moment(Mode::Active);
    moment.state.step = 1;
    moment.input.request.step = step, moment.input.request.step_reached = true;
    EXPECT_EQ(moment.event(), step == 1 ? Event::StepReached : Event::None) << step;
  }
}

TEST(Supervisor, StepsAreDoneWhenTheyAreReachedAndNotWhenTheMotionWasStopped) {
  Moment reached(Mode::Active), stopped(Mode::Active);
  reached.input.request.step_reached = true;
  stopped.input.stop = StopCategory::C2Hold;
  EXPECT_TRUE(reached.next().step_done);
  EXPECT_TRUE(reached.output().step_done);
  EXPECT_EQ(stopped.event(), Event::Stop);
  EXPECT_FALSE(stopped.next().step_done);
}

TEST(Supervisor, StepsAreNeverAllowedMoreDepthThanThePlan) {
  verifies("R-31");
  Moment moment(Mode::Active);
  moment.plan.depth_max_um = 3'000;
  EXPECT_EQ(moment.permit().depth_max_um, 3'000);
}

Moment end_of_step(std::uint32_t step) {
  Moment moment(Mode::Hold, 11, true);
  moment.state.step = step, moment.state.step_done = true;
  return moment;
}

TEST(Supervisor, GoingOnNeedsTheAcceptanceOfThisVeryStep) {
  for (const std::uint32_t accepted : {0U, 1U, 2U}) {
    Moment moment = end_of_step(1);
    moment.input.depth_accepted = true, moment.input.accepted_step = accepted;
    EXPECT_EQ(moment.event(), accepted == 1 ? Event::Move : Event::None) << accepted;
    EXPECT_EQ(moment.refusal(), accepted == 1 ? Refusal::None : Refusal::DepthNotAccepted) << accepted;
  }
}

TEST(Supervisor, GoingOnTakesUpTheNextStepAtTheEndOfOneAndTheSameInside) {
  Moment end = end_of_step(1), inside = end_of_step(1);
  end.input.depth_accepted = true, end.input.accepted_step = 1;
  inside.state.step_done = false;
  EXPECT_EQ(end.next().step, 2U);
  EXPECT_FALSE(end.next().step_done);
  EXPECT_EQ(end.output().step, 2U);
  EXPECT_EQ(inside.event(), Event::Move) << "nothing has to be accepted there";
  EXPECT_EQ(inside.next().step, 1U);
}

TEST(Supervisor, GoingOnWaitsUntilNothingAsksForAStop) {
  Moment moment(Mode::Hold, 11, true);
  moment.input.stop = StopCategory::C2Hold;
  EXPECT_EQ(moment.event(), Event::None);
  EXPECT_EQ(moment.refusal(), Refusal::Unhealthy);
}

TEST(Supervisor, GoingOnEndsWithTheLastStepOfThePlanAndWithTheRoomForSteps) {
  for (const std::uint32_t step : {2U, 3U, 5U})
    EXPECT_EQ(end_of_step(step).refusal(), Refusal::PlanDone) << step;
  for (const std::uint32_t count : {32U, 33U}) {
    Moment last = end_of_step(30), beyond = end_of_step(31);
    last.plan.step_count = beyond.plan.step_count = count;
    last.plan.steps[30].image_confirms = false;
    EXPECT_EQ(last.event(), Event::Move) << count;
    EXPECT_EQ(beyond.refusal(), Refusal::PlanDone) << count;
  }
}

TEST(Supervisor, RefusalsAreNoneForWhatIsDoneWhateverElseIsAsked) {
  Moment arm(Mode::Ready), reset(Mode::Trip), press(Mode::Armed, 11, true);
  arm.input.local_arm = reset.input.local_reset = true;
  for (const bool remote : {false, true}) {
    for (Moment* moment : {&arm, &reset, &press}) {
      moment->input.remote_arm = remote;
      EXPECT_EQ(moment->refusal(), Refusal::None) << name_of(moment->event());
    }
  }
}

TEST(Supervisor, RefusalsOfAPressSayNotArmedWhereNothingCanMoveHoweverOldItIs) {
  for (const Mode mode : {Mode::Safe, Mode::Ready, Mode::Trip})
    for (const std::uint32_t token : {9U, 10U, 11U})
      EXPECT_EQ(Moment(mode, token, true).refusal(), Refusal::NotArmed) << name_of(mode) << ' ' << token;
  EXPECT_EQ(Moment(Mode::Active, 11, true).refusal(), Refusal::NotArmed) << "a second button";
}

TEST(Supervisor, RefusalsAreNoneWhereNothingIsAsked) {
  for (const Mode mode : {Mode::Ready, Mode::Armed, Mode::Active}) {
    EXPECT_EQ(Moment(mode, 0, true).refusal(), Refusal::None) << "no button at all";
    EXPECT_EQ(Moment(mode, 10, false).refusal(), Refusal::None) << "a release";
    EXPECT_EQ(Moment(mode, 11, false).refusal(), Refusal::None) << "a release";
  }
  EXPECT_EQ(Moment(Mode::Active, 10, true).refusal(), Refusal::None) << "the button that moves it";
  EXPECT_EQ(Moment(Mode::Active, 9, true).refusal(), Refusal::None) << "one that came late";
}

}  // namespace
}  // namespace biopsy::safety
