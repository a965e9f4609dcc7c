// What a controller process can get wrong: which plan it runs, which step, and what it stamps on its
// requests.
#include "robot/cycle/control.hpp"

#include <gtest/gtest.h>

#include "planner/plan/seal.hpp"

namespace biopsy::robot {
namespace {

Plan plan_to(double depth_mm) {
  Plan plan;
  plan.target_depth = Millimetres(depth_mm);
  for (const double share : {0.5, 1.0})
    plan.steps.push_back({.depth = Millimetres(share * depth_mm),
                          .speed = MillimetresPerSecond(1000.0),
                          .v_max = Volts(5000),
                          .dwell = Seconds(0.001),
                          .why = ""});
  planner::seal(plan);
  return plan;
}

SealedPlan sealed_for_control(const Plan& plan) {
  return {.seq = 1, .bytes = planner::canonical_bytes(plan), .seal = plan.seal};
}

ControllerInputs driven(std::uint32_t step) {
  ControllerInputs in;
  in.measurement.seq = 41;
  in.permit.hv_enable = true;
  in.permit.slew_up_mV_per_tick = 80'000;
  in.permit.v_max_mV = 5'000'000;
  in.step = step;
  return in;
}

TEST(Control, DrivesTheStepThatTheSupervisorWants) {
  for (const std::uint32_t step : {0U, 1U}) {
    ControllerMemory memory;
    load_plan(sealed_for_control(plan_to(2.0)), memory);
    ControllerInputs in = driven(step);
    in.measurement.depth_um = 1'000 * static_cast<std::int32_t>(step + 1);
    DriveRequest request;
    for (int tick = 0; tick < 5; ++tick) request = control(in, memory);
    EXPECT_EQ(request.step, step);
    EXPECT_TRUE(request.step_reached);
    EXPECT_EQ(request.setpoint_um, in.measurement.depth_um);
  }
}

TEST(Control, StampsItsPlanConfigurationOverrunsAndMeasurement) {
  const Plan plan = plan_to(2.0);
  ControllerMemory memory;
  memory.config_tag = 5;
  load_plan(sealed_for_control(plan), memory);
  ControllerInputs in = driven(0);
  in.overruns = 3;
  in.finish = true;
  const DriveRequest request = control(in, memory);
  EXPECT_EQ(request.plan_tag, planner::plan_tag(plan));
  EXPECT_EQ(request.plan_seal, plan.seal);
  EXPECT_EQ(request.config_tag, 5U);
  EXPECT_EQ(request.overruns, 3U);
  EXPECT_EQ(request.measured_seq, 41U);
  EXPECT_TRUE(request.finished);
}

TEST(Control, RequestsNothingWithoutAPlanThatHasTheStep) {
  ControllerMemory memory;
  const DriveRequest without = control(driven(0), memory);
  EXPECT_EQ(without.wanted_mV, 0);
  EXPECT_EQ(without.seq, 1U) << "alive";
  EXPECT_EQ(without.plan_tag, 0U);
  EXPECT_EQ(without.measured_seq, 41U) << "it answers all the same";
  load_plan(sealed_for_control(plan_to(2.0)), memory);
  const DriveRequest beyond = control(driven(2), memory);
  EXPECT_EQ(beyond.wanted_mV, 0);
  EXPECT_FALSE(beyond.step_reached);
  EXPECT_EQ(beyond.seq, 2U) << "numbers go on with a new plan";
  EXPECT_EQ(control(driven(3), memory).wanted_mV, 0);
}

TEST(Control, BeginsANewPlanAfresh) {
  ControllerMemory memory;
  load_plan(sealed_for_control(plan_to(2.0)), memory);
  for (int tick = 0; tick < 20; ++tick) control(driven(1), memory);
  EXPECT_GT(memory.runner.setpoint.value, 0.0);
  load_plan(sealed_for_control(plan_to(3.0)), memory);
  EXPECT_EQ(memory.runner.setpoint.value, 0.0);
  EXPECT_EQ(memory.runner.step, 0U);
  EXPECT_EQ(memory.runner.drive_ticks, 0U);
}

TEST(Control, LocksTheNeedleWhereItShallHoldStillAndNotWhereItShallComeOut) {
  for (const bool still : {false, true}) {
    ControllerMemory memory;
    load_plan(sealed_for_control(plan_to(2.0)), memory);
    ControllerInputs in = driven(0);
    in.permit.slew_up_mV_per_tick = 0;
    in.permit.brake = in.measurement.brake_fitted = true;
    in.hold_still = still;
    in.finish = !still;
    const DriveRequest request = control(in, memory);
    EXPECT_EQ(request.brake, still);
    EXPECT_EQ(request.finished, !still);
  }
}

TEST(Control, RunsNoPlanWhoseSealIsBrokenOrThatHasNoStep) {
  ControllerMemory memory;
  load_plan(sealed_for_control(plan_to(2.0)), memory);
  SealedPlan broken = sealed_for_control(plan_to(3.0));
  broken.bytes[9] ^= 1;
  load_plan(broken, memory);
  EXPECT_FALSE(memory.plan);
  EXPECT_EQ(memory.plan_tag, 0U);
  Plan empty = plan_to(2.0);
  empty.steps.clear();
  planner::seal(empty);
  load_plan(sealed_for_control(empty), memory);
  EXPECT_FALSE(memory.plan);
}

}  // namespace
}  // namespace biopsy::robot
