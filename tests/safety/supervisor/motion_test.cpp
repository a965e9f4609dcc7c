// Hold-to-run, steps and depth checks in the loop: what makes the needle go on, and what cannot.
#include <gtest/gtest.h>

#include "safety/types/thresholds.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/situation.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

// Ends the present step and lets the button go.
void reach(Rig& rig) {
  rig.reached = true;
  rig.run(2);
  rig.reached = false;
  rig.release();
  rig.run(2);
}

TEST(SafetyLoop, HoldToRunStopsInTheTickOfTheRelease) {
  verifies("R-41");
  Rig rig;
  EXPECT_TRUE(rig.go_hold());
  EXPECT_EQ(rig.state.last_event, Event::Stop);
  EXPECT_EQ(rig.output.permit.slew_up_mV_per_tick, 0);
}

TEST(SafetyLoop, HoldToRunStopsWhenTheConsoleFallsSilent) {
  verifies("R-41");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.release();
  EXPECT_EQ(rig.ticks_until([&] { return rig.state.mode == Mode::Hold; }, 1'000), kHeldTimeout_ms + 1);
}

TEST(SafetyLoop, HoldToRunALateHeartbeatOfASpentTokenCannotRestartMotion) {
  verifies("R-41");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  const std::uint32_t spent = rig.state.token;
  rig.release();
  ASSERT_LE(rig.ticks_until([&] { return rig.state.mode == Mode::Hold; }, 1'000), 1'000);
  rig.held = spent;
  rig.run(50);
  EXPECT_EQ(rig.state.mode, Mode::Hold);
  EXPECT_EQ(rig.output.refusal, Refusal::TokenSpent);
  rig.held = spent - 1;
  rig.run(50);
  EXPECT_EQ(rig.state.mode, Mode::Hold);
  rig.press();
  rig.tick();
  EXPECT_EQ(rig.state.mode, Mode::Active);
}

TEST(SafetyLoop, HoldToRunAPressWhileNotArmedIsSpentAndMustBeRepeated) {
  verifies("R-41");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.press();
  rig.tick();
  EXPECT_EQ(rig.output.refusal, Refusal::NotArmed);
  rig.arm = true;
  rig.run(20);
  EXPECT_EQ(rig.state.mode, Mode::Armed);
  EXPECT_EQ(rig.output.refusal, Refusal::TokenSpent);
  rig.press();
  rig.tick();
  EXPECT_EQ(rig.state.mode, Mode::Active);
}

TEST(SafetyLoop, HoldToRunASecondPressDuringMotionStopsIt) {
  verifies("R-41");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.press();
  rig.tick();
  EXPECT_EQ(rig.state.mode, Mode::Hold);
  rig.run(20);
  EXPECT_EQ(rig.state.mode, Mode::Hold);
}

TEST(SafetyLoop, HoldToRunAnOldTokenNeitherStopsNorFeedsTheMotion) {
  Rig rig;
  ASSERT_TRUE(rig.go_hold());
  rig.press();
  rig.tick();
  ASSERT_EQ(rig.state.mode, Mode::Active);
  rig.held -= 1;
  rig.run(kHeldTimeout_ms);
  EXPECT_EQ(rig.state.mode, Mode::Active);
  rig.tick();
  EXPECT_EQ(rig.state.mode, Mode::Hold);
}

TEST(SafetyLoop, StepsEndInHoldAndGoOnWithAFreshPress) {
  verifies("R-42");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  EXPECT_EQ(rig.output.permit.depth_max_um, rig.plan.steps[0].depth_max_um);
  rig.reached = true;
  rig.run(2);
  EXPECT_EQ(rig.state.mode, Mode::Hold);
  EXPECT_TRUE(rig.output.step_done);
  EXPECT_TRUE(rig.output.image_allowed);
  rig.reached = false;
  rig.run(50);
  EXPECT_EQ(rig.state.mode, Mode::Hold) << "the button still held must not go on by itself";
  rig.press();
  rig.tick();
  EXPECT_EQ(rig.state.mode, Mode::Active);
  EXPECT_EQ(rig.output.step, 1U);
  EXPECT_GT(rig.output.permit.v_max_mV, 6'000'000);
  EXPECT_LE(rig.output.permit.v_max_mV, rig.plan.steps[1].v_max_mV);
  EXPECT_FALSE(rig.output.image_allowed);
}

TEST(SafetyLoop, StepsWaitForTheDepthCheckOfThatVeryStep) {
  verifies("R-42");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  reach(rig);
  rig.press();
  rig.tick();
  reach(rig);
  ASSERT_EQ(rig.output.step, 1U);
  rig.press();
  rig.tick();
  EXPECT_EQ(rig.state.mode, Mode::Hold);
  EXPECT_EQ(rig.output.refusal, Refusal::DepthNotAccepted);
  rig.depth_accepted = true;
  rig.run(5);
  EXPECT_EQ(rig.state.mode, Mode::Hold) << "a refused press is spent";
  rig.on_input = [](Situation& input) { input.accepted_step = 0; };
  rig.press();
  rig.tick();
  EXPECT_EQ(rig.output.refusal, Refusal::DepthNotAccepted) << "accepted for another step";
  rig.on_input = [](Situation&) {};
  rig.press();
  rig.tick();
  EXPECT_EQ(rig.state.mode, Mode::Active);
  EXPECT_EQ(rig.output.step, 2U);
}

TEST(SafetyLoop, StepsMayBeInterruptedAndResumedWithoutADepthCheck) {
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  reach(rig);
  rig.press();
  rig.run(50);
  ASSERT_EQ(rig.output.step, 1U);
  rig.stop = StopCategory::C2Hold;
  rig.tick();
  rig.press();
  rig.tick();
  EXPECT_EQ(rig.output.refusal, Refusal::Unhealthy) << "the stop is still asked for";
  rig.stop = StopCategory::None;
  rig.press();
  rig.tick();
  EXPECT_EQ(rig.state.mode, Mode::Active);
  EXPECT_EQ(rig.output.step, 1U);
}

TEST(SafetyLoop, StepsThereIsNothingBehindTheLast) {
  Rig rig;
  rig.depth_accepted = true;
  ASSERT_TRUE(rig.go_active());
  reach(rig);
  for (int i = 0; i < 2; ++i) rig.press(), rig.tick(), reach(rig);
  ASSERT_EQ(rig.output.step, 2U);
  rig.press();
  rig.tick();
  EXPECT_EQ(rig.output.refusal, Refusal::PlanDone);
  EXPECT_EQ(rig.state.mode, Mode::Hold);
}

TEST(SafetyLoop, StepsAStepReachedBelongsToTheStepBeingDriven) {
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_request = [](DriveRequest& request) { request.step = 2, request.step_reached = true; };
  rig.run(10);
  EXPECT_EQ(rig.state.mode, Mode::Active);
}

TEST(SafetyLoop, StepsAFinishedPlanRetractsAndStartsOverFromTheFirstStep) {
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  reach(rig);
  rig.finished = true;
  rig.run(2);
  EXPECT_EQ(rig.state.mode, Mode::Retract);
  EXPECT_EQ(rig.state.last_event, Event::Finished);
  rig.finished = false;
  ASSERT_LE(rig.ticks_until([&] { return rig.state.mode == Mode::Ready; }, 400), 400);
  rig.arm = true;
  rig.tick();
  EXPECT_EQ(rig.output.step, 0U);
  EXPECT_FALSE(rig.output.step_done);
}

TEST(SafetyLoop, StepsNeverAllowMoreThanTheRobotsOwnLimits) {
  verifies("R-35");
  Rig rig;
  rig.plan.steps[0].v_max_mV = 20'000'000;
  rig.plan.steps[0].slew_up_mV_per_tick = 20'000'000;
  rig.plan.steps[0].depth_max_um = 20'000;
  SupervisorState state = rig.state;
  state.mode = Mode::Active;
  Situation input;
  input.evidence.clear = kAllHazards;
  input.evidence.ceiling_mV = 20'000'000;
  const Permit permit = step(rig.plan, state, input).second.permit;
  EXPECT_EQ(permit.v_max_mV, 8'000'000);
  EXPECT_EQ(permit.slew_up_mV_per_tick, 400'000);
  EXPECT_EQ(permit.depth_max_um, rig.plan.depth_max_um);
  state.step = 9;
  EXPECT_EQ(step(rig.plan, state, input).second.permit.v_max_mV, 0) << "a step the plan does not have";
}

TEST(SafetyLoop, ImagesAreSoundWhereNothingSwitched) {
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  EXPECT_FALSE(rig.evidence.image_disturbed);
}

TEST(SafetyLoop, ImagesAreFlaggedWhenTheDriveSwitchesWhileTheyAreTaken) {
  verifies("R-49");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_observation = [](SupervisorInputs& seen) { seen.acquiring = true; };
  int disturbed = 0;
  for (int i = 0; i < 500; ++i) rig.tick(), disturbed += rig.output.image_disturbed;
  EXPECT_EQ(disturbed, 2) << "one for each change of polarity";
}

}  // namespace
}  // namespace biopsy::safety
