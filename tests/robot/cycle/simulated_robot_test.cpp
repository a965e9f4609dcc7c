// The controller of the simulated robot gets what the cycle and the operator give it.
#include "robot/cycle/simulated_robot.hpp"

#include <gtest/gtest.h>

#include "tests/robot/cycle/ideal_cycle.hpp"

namespace biopsy::robot {
namespace {

struct SimulatedRobotTest : testing::Test {
  const Plan plan = plan_of_two_steps(0.1);  // no way of a needle without a drive that would be noticed
  IdealStage stage;
  SimulatedRobot robot{
      plan, plan_facts(plan, kConfigOfCycle), stage, {planner::plan_tag(plan), planner::plan_tag(plan)}};

  void run_until(Mode mode, const OperatorInputs& inputs) {
    for (int tick = 0; tick < 3'000 && robot.mode() != mode; ++tick) robot.run_cycle(inputs);
    ASSERT_EQ(robot.mode(), mode);
  }
  OperatorInputs go() {
    OperatorInputs inputs = OperatorInputs::idle();
    run_until(Mode::Ready, inputs);
    inputs.arm = true;
    run_until(Mode::Armed, inputs);
    inputs.arm = false;
    inputs.press = {1, true};
    run_until(Mode::Active, inputs);
    return inputs;
  }
};

TEST_F(SimulatedRobotTest, DrivesTheStepThatTheSupervisorWantsWithinItsPermit) {
  const OperatorInputs inputs = go();
  CycleRecord record;
  for (int tick = 0; tick < 20; ++tick) record = robot.run_cycle(inputs);
  EXPECT_EQ(record.request.measured_seq, record.measurement.seq);
  EXPECT_EQ(record.request.step, record.supervisor.step);
  EXPECT_GT(record.request.setpoint_um, 0) << "the plan's first step, from where the needle is";
  EXPECT_NE(record.request.wanted_mV, 0);
  EXPECT_NE(record.drive_mV, 0);
  EXPECT_EQ(robot.controller().seq, record.request.seq);
  EXPECT_EQ(static_cast<std::int64_t>(record.request.seq), robot.ticks());
}

TEST_F(SimulatedRobotTest, WithdrawsWhenTheOperatorIsDone) {
  OperatorInputs inputs = go();
  EXPECT_FALSE(robot.run_cycle(inputs).request.finished);
  inputs.finish = true;
  EXPECT_TRUE(robot.run_cycle(inputs).request.finished);
}

// The needle is where the controller wants it, to the end of the first step.
TEST_F(SimulatedRobotTest, LocksTheNeedleOfAStepThatIsDoneWhenTheOperatorWantsAnImage) {
  OperatorInputs inputs = go();
  CycleRecord record;
  for (int tick = 0; tick < 4'000 && !record.supervisor.permit.brake; ++tick) {
    record = robot.run_cycle(inputs);
    stage.depth_um = record.request.setpoint_um;
  }
  ASSERT_TRUE(record.supervisor.permit.brake)
      << "it has arrived: " << cause_of(record.supervisor, record.panel_unread_ms);
  record = robot.run_cycle(inputs);
  EXPECT_FALSE(record.request.brake);
  inputs.hold_still = true;
  EXPECT_TRUE(robot.run_cycle(inputs).request.brake);
}

TEST_F(SimulatedRobotTest, RaisesNothingOnABusWithASecondWriter) {
  const OperatorInputs inputs = go();
  CycleRecord record;
  for (int tick = 0; tick < 50; ++tick) record = robot.run_cycle(inputs, {.log_backlog_ms = 0, .writers = 2});
  EXPECT_EQ(record.drive_mV, 0);
  EXPECT_NE(robot.mode(), Mode::Active);
}

TEST_F(SimulatedRobotTest, ShowsItsHooksWhatTheGateGets) {
  Watch watch;
  robot.wrap(watch);
  const CycleRecord record = robot.run_cycle(OperatorInputs::idle());
  EXPECT_EQ(watch.gated.request, record.request);
}

}  // namespace
}  // namespace biopsy::robot
