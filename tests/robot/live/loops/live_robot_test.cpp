// The operator's side of the live robot: what its thread sends while the operator's program asks, and once
// that stands still; what it makes of the ticks that it receives.
#include <chrono>
#include <future>

#include "drivers/digital_io/shared_io.hpp"
#include "planner/plan/seal.hpp"
#include "robot/common/operator_name.hpp"
#include "tests/robot/live/loops/live_robot_bench.hpp"

namespace biopsy::loops_tests {
namespace {

TEST_F(LiveRobotBench, SendsNothingBeforeAnOperatorAsks) {
  turn(1'000);
  turn(500'000);
  EXPECT_TRUE(fake_bus::written<OperatorAct>().empty());
  EXPECT_TRUE(fake_bus::written<DepthVerdictNote>().empty());
}

TEST_F(LiveRobotBench, SendsEachInputInItsFieldAtOnce) {
  std::int64_t us = 0;
  const auto sent = [&](const auto& set) {
    robot::OperatorInputs inputs = asked();
    set(inputs);
    (void)ask(asked(), us += 50'000);
    fake_bus::written<OperatorAct>();
    (void)ask(inputs, us += 1'000);
    const std::vector<OperatorAct> acts = fake_bus::written<OperatorAct>();
    EXPECT_EQ(acts.size(), 1U);
    return acts.empty() ? OperatorAct{} : acts.back();
  };
  EXPECT_EQ(sent([](auto& in) { in.press = {42, true}; }).token, 42U);
  EXPECT_FALSE(sent([](auto& in) { in.press = {41, false}; }).held);
  EXPECT_EQ(sent([](auto& in) { in.stop = StopCategory::C1Ramp; }).stop, StopCategory::C1Ramp);
  EXPECT_TRUE(sent([](auto& in) { in.finish = true; }).finish);
  EXPECT_TRUE(sent([](auto& in) { in.acquiring = true; }).acquiring);
  EXPECT_TRUE(sent([](auto& in) { in.hold_still = true; }).hold_still);
  EXPECT_TRUE(sent([](auto& in) { in.remote_arm = true; }).arm);
  EXPECT_TRUE(sent([](auto& in) { in.remote_reset = true; }).reset);
  EXPECT_EQ(sent([](auto& in) { in.patient_motion_um = 321; }).patient_motion_um, 321);
}

TEST_F(LiveRobotBench, RepeatsAnActEveryTwentyMillisecondsWithARisingNumber) {
  (void)ask(asked(), 1'000);
  std::vector<OperatorAct> acts = fake_bus::written<OperatorAct>();
  ASSERT_EQ(acts.size(), 1U);
  for (int ms = 2; ms <= 61; ++ms) turn(1'000 * ms);
  acts = fake_bus::written<OperatorAct>();
  ASSERT_EQ(acts.size(), 3U);
  for (std::uint32_t n = 0; n < 3; ++n) EXPECT_EQ(acts[n].seq, n + 2);
  EXPECT_TRUE(acts.back().held);
}

TEST_F(LiveRobotBench, HoldsNothingForAProgramThatStandsStillWhileItsThreadGoesOn) {
  (void)ask(asked(), 1'000);
  turn(100'900);
  EXPECT_TRUE(fake_bus::written<OperatorAct>().back().held);
  turn(101'200);
  ASSERT_FALSE(fake_bus::written<OperatorAct>().empty());
  std::vector<OperatorAct> later;
  for (int ms = 102; ms < 400; ++ms) {
    turn(1'000 * ms);
    for (const OperatorAct& act : fake_bus::written<OperatorAct>()) later.push_back(act);
  }
  ASSERT_FALSE(later.empty());
  for (const OperatorAct& act : later) EXPECT_FALSE(act.held);
  EXPECT_EQ(later.back().token, 41U);
}

// Its stop stays asked for, and its panel is still there, however long it stands still.
TEST_F(LiveRobotBench, KeepsTheStopOfAProgramThatStandsStill) {
  digital_io::StageIo driver(folder.path());
  const digital_io::IoReader reader(folder.path());
  robot::OperatorInputs inputs = asked();
  inputs.stop = StopCategory::C1Ramp;
  (void)ask(inputs, 1'000);
  for (const std::int64_t us : {300'000, 20'000'000}) {
    fake_bus::written<OperatorAct>();
    turn(us);
    const std::vector<OperatorAct> acts = fake_bus::written<OperatorAct>();
    ASSERT_EQ(acts.size(), 1U) << us;
    EXPECT_EQ(acts.front().stop, StopCategory::C1Ramp);
  }
  Decision decision;  // a supervisor that was started meanwhile has its panel proven
  decision.session = 8;
  fake_bus::put(decision);
  bool opened = false;
  for (std::int64_t us = 20'100'000; us < 20'600'000; us += 10'000) {
    turn(us);
    driver.mark_panel_read((kStart_us + us) * 1'000);
    opened |= !reader.panel((kStart_us + us) * 1'000).levels.estop_a_closed;
  }
  EXPECT_TRUE(opened);
}

TEST_F(LiveRobotBench, SendsAVerdictWhenAnyFieldOfItChangesAndOnlyThen) {
  Plan plan;
  planner::seal(plan);
  robot->send_plan(plan, {1, 2});
  const std::vector<SealedPlan> plans = fake_bus::written<SealedPlan>();
  ASSERT_EQ(plans.size(), 1U);
  EXPECT_EQ(plans.front(), (SealedPlan{1, planner::canonical_bytes(plan), plan.seal, {1, 2}}));
  robot::OperatorInputs inputs = asked();
  std::int64_t us = 0;
  std::uint32_t sent = 0;
  const auto expect_sent = [&](const auto& check) {
    (void)ask(inputs, us += 1'000);
    const std::vector<DepthVerdictNote> verdicts = fake_bus::written<DepthVerdictNote>();
    ASSERT_EQ(verdicts.size(), 1U);
    EXPECT_EQ(verdicts.front().seq, ++sent);
    EXPECT_EQ(verdicts.front().plan_tag, planner::plan_tag(plan));
    EXPECT_TRUE(check(verdicts.front()));
    (void)ask(inputs, us += 1'000);
    EXPECT_TRUE(fake_bus::written<DepthVerdictNote>().empty()) << "once";
  };
  inputs.depth_accepted = true;
  expect_sent([](const DepthVerdictNote& note) { return note.accepted && note.step == 0; });
  inputs.accepted_step = 3;
  expect_sent([](const DepthVerdictNote& note) { return note.accepted && note.step == 3; });
  inputs.accepted_session = 4;
  expect_sent([](const DepthVerdictNote& note) { return note.session == 4; });
  inputs.accepted_since_seq = 5;
  expect_sent([](const DepthVerdictNote& note) { return note.since_seq == 5; });
  inputs.depth_accepted = false;
  expect_sent([](const DepthVerdictNote& note) { return !note.accepted && note.step == 3; });
  plan.target_depth = Millimetres(7.0);
  planner::seal(plan);
  robot->send_plan(plan, {3, 4});
  EXPECT_EQ(fake_bus::written<SealedPlan>().front().seq, 2U);
  expect_sent([](const DepthVerdictNote& note) { return !note.accepted; });  // with the new plan's tag
}

TEST_F(LiveRobotBench, TurnsTheKeysOfTheSimulatedPanel) {
  digital_io::StageIo driver(folder.path());
  const digital_io::IoReader reader(folder.path());
  std::int64_t us = 1'000;
  const auto levels = [&](const robot::OperatorInputs& inputs) {
    (void)ask(inputs, us += 1'000);
    driver.mark_panel_read((kStart_us + us) * 1'000);
    return reader.panel((kStart_us + us) * 1'000).levels;
  };
  robot::OperatorInputs inputs = asked();
  EXPECT_FALSE(levels(inputs).arm_key);
  inputs.arm = true;
  EXPECT_TRUE(levels(inputs).arm_key);
  inputs.arm = false, inputs.reset = true;
  EXPECT_TRUE(levels(inputs).reset_key);
  EXPECT_TRUE(levels(inputs).estop_a_closed && levels(inputs).estop_b_closed);
  inputs.estop_closed = false;
  EXPECT_FALSE(levels(inputs).estop_a_closed || levels(inputs).estop_b_closed);
}

TEST_F(LiveRobotBench, ReturnsEveryTickInOrderWithWhatWasPutOutThen) {
  DriveRequest request;
  request.setpoint_um = 1'500;
  Permit permit;
  permit.v_max_mV = 77;
  Decision decision;
  decision.mode = Mode::Hold;
  decision.step = 2;
  const StageTruth truth{1, 1'250'000, -3'000'000, 4, 5};
  fake_bus::put(request);
  fake_bus::put(permit);
  fake_bus::put(decision);
  fake_bus::put(truth);
  for (const std::uint32_t n : {1U, 2U, 3U, 7U}) {
    Measurement measured;
    measured.seq = n;
    measured.command_mV = -static_cast<std::int32_t>(100 * n);
    fake_bus::put(measured);
  }
  turn(1'000);
  EXPECT_EQ(robot->lost(), 3U);
  for (const std::uint32_t n : {1U, 2U, 3U}) {
    const auto sample = robot->tick(asked());
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->record.measurement.seq, n);
    EXPECT_EQ(sample->record.drive_mV, -static_cast<std::int32_t>(n == 3 ? 700 : 100 * (n + 1)));
    EXPECT_EQ(sample->newest, n == 3);
    EXPECT_EQ(sample->record.request, request);
    EXPECT_EQ(sample->record.supervisor.permit.v_max_mV, 77);
    EXPECT_EQ(sample->record.supervisor.permit.mode, Mode::Hold);
    EXPECT_EQ(sample->record.supervisor.step, 2U);
    EXPECT_DOUBLE_EQ(sample->truth.tip_mm, 1.25);
    EXPECT_DOUBLE_EQ(sample->truth.plate_b_mm, -3.0);
    EXPECT_EQ(sample->truth.layers_entered, 4);
    EXPECT_EQ(sample->truth.active_faults, 5U);
    EXPECT_DOUBLE_EQ(sample->setpoint.value, 1.5);
  }
}

TEST_F(LiveRobotBench, KnowsTheHealthOfEachProcessForHalfASecond) {
  for (const Process process :
       {Process::Interlock, Process::Recorder, Process::Supervisor, Process::Stage, Process::Controller}) {
    Health health;
    health.process = process;
    health.seq = 100 + static_cast<std::uint32_t>(process);
    fake_bus::put(health);
    turn(1'000);
    EXPECT_EQ(robot->health()[static_cast<std::size_t>(process)], health);
  }
  turn(501'000);
  EXPECT_NE(robot->health()[static_cast<std::size_t>(Process::Stage)].seq, 0U);
  turn(501'100);
  EXPECT_EQ(robot->health()[static_cast<std::size_t>(Process::Stage)].seq, 0U);
  EXPECT_EQ(robot->health()[static_cast<std::size_t>(Process::Stage)].process, Process::Stage);
}

TEST_F(LiveRobotBench, SaysThatItIsReadyWithItsConfiguration) {
  turn(200'000);
  const std::vector<Health> sent = fake_bus::written<Health>();
  ASSERT_FALSE(sent.empty());
  EXPECT_EQ(sent.back().process, Process::Person);
  EXPECT_EQ(sent.back().config_tag, kConfig);
  EXPECT_TRUE(sent.back().ready);
  EXPECT_EQ(sent.back().note, operator_name()) << "who operates, for the log";
}

TEST_F(LiveRobotBench, RetractsWithARampUntilHighVoltageIsNoLongerPermitted) {
  Permit permit;
  permit.hv_enable = false;
  fake_bus::put(permit);
  put_measurement();
  put_measurement();
  turn(1'000);
  robot->retract();
  turn(2'000);
  EXPECT_EQ(fake_bus::written<OperatorAct>().back().stop, StopCategory::C1Ramp);
}

TEST_F(LiveRobotBench, KeepsItsTimesToTheMicrosecond) {
  (void)ask(asked(), 1'000);
  fake_bus::written<OperatorAct>();
  turn(20'999);
  EXPECT_TRUE(fake_bus::written<OperatorAct>().empty());
  turn(21'000);
  EXPECT_EQ(fake_bus::written<OperatorAct>().size(), 1U);
  turn(101'000);
  EXPECT_TRUE(fake_bus::written<OperatorAct>().back().held) << "100 ms without asking";
  turn(101'001);
  EXPECT_FALSE(fake_bus::written<OperatorAct>().back().held);
  EXPECT_EQ(fake_bus::state().watched, 1U);
}

TEST_F(LiveRobotBench, RetractsForAsLongAsHighVoltageIsPermittedAndNoLonger) {
  Permit permit;
  permit.hv_enable = true;
  fake_bus::put(permit);
  for (int n = 0; n < 4; ++n) put_measurement();
  turn(1'000);  // three ticks with, then one without
  permit.hv_enable = false, permit.brake = true;
  fake_bus::put(permit);
  put_measurement();
  put_measurement();
  turn(2'000);
  robot->retract();
  const auto next = robot->tick(asked());
  ASSERT_TRUE(next);
  EXPECT_EQ(next->record.measurement.seq, 5U);
}

TEST_F(LiveRobotBench, RetractsForSixHundredTicksAtMost) {
  Permit permit;
  permit.hv_enable = true;
  fake_bus::put(permit);
  for (int turns_ms = 1; turns_ms <= 70; ++turns_ms) {
    for (int n = 0; n < 10; ++n) put_measurement();
    turn(1'000 * turns_ms);
  }
  robot->retract();
  const auto next = robot->tick(asked());
  ASSERT_TRUE(next);
  EXPECT_EQ(next->record.measurement.seq, 601U);
}

TEST_F(LiveRobotBench, ReturnsNothingWhereNoTickCame) {
  EXPECT_FALSE(robot->tick(asked()));
}

// On the machine's clock, as the operator's program waits: the fastest of a few, so that a busy machine does
// not matter.
TEST_F(LiveRobotBench, WakesTheProgramThatWaitsOnceItsTickCame) {
  using Clock = std::chrono::steady_clock;
  Clock::duration fastest = std::chrono::hours(1);
  put_measurement();
  turn(1'000);
  for (std::uint32_t n = 0; n < 3; ++n) {
    robot::OperatorInputs inputs = asked();
    inputs.press.token = 50 + n;
    auto waits = std::async(std::launch::async, [&] { return robot->tick(inputs).has_value(); });
    std::int64_t us = 1'000'000 * (n + 1);
    const auto is_sent = [&] {
      const std::vector<OperatorAct> acts = fake_bus::written<OperatorAct>();
      return !acts.empty() && acts.back().token == inputs.press.token;
    };
    do turn(us += 20'000);  // it holds the lock from its inputs to its wait
    while (!is_sent());
    const Clock::time_point came = Clock::now();
    put_measurement();
    turn(us += 1'000);
    EXPECT_TRUE(waits.get());
    fastest = std::min<Clock::duration>(fastest, Clock::now() - came);
  }
  EXPECT_LT(fastest, std::chrono::milliseconds(700)) << "it would wait for a second by itself";
}

TEST_F(LiveRobotBench, CountsTicksThatItMissedAndNoneThatCameTwiceOrFromAnotherStart) {
  const auto lost_after = [&](std::uint32_t number) {
    Measurement measured;
    measured.seq = number;
    measured.answer = 3;
    fake_bus::put(measured);
    turn(1'000);
    return robot->lost();
  };
  EXPECT_EQ(lost_after(5), 0U) << "the first";
  EXPECT_EQ(lost_after(6), 0U);
  EXPECT_EQ(lost_after(8), 1U);
  EXPECT_EQ(lost_after(8), 1U);
  EXPECT_EQ(lost_after(2), 1U);
  EXPECT_EQ(lost_after(5), 3U);
}

TEST_F(LiveRobotBench, KnowsOfEvidenceAsFarAsTheDecisionTells) {
  Decision decision;
  decision.worst = static_cast<std::uint8_t>(safety::Hazard::Arc);
  decision.reason = static_cast<std::uint8_t>(safety::Hazard::OverDepth);
  decision.panel_unread_ms = 143;
  for (const bool estop : {false, true}) {
    decision.estop = estop;
    fake_bus::put(decision);
    const auto sample = ask(asked(), estop ? 2'000 : 1'000);
    ASSERT_TRUE(sample);
    safety::HazardSet found = safety::bit(safety::Hazard::Arc);
    if (estop) found |= safety::bit(safety::Hazard::EStop);
    EXPECT_EQ(sample->record.evidence.clear, safety::kAllHazards & ~found);
    EXPECT_EQ(sample->record.panel_unread_ms, 143);
  }
}

TEST_F(LiveRobotBench, TestsTheSimulatedPanelOnceInEachSessionOfTheSupervisor) {
  digital_io::StageIo driver(folder.path());
  const digital_io::IoReader reader(folder.path());
  for (const std::uint32_t session : {5U, 6U}) {
    Decision decision;
    decision.session = session;
    decision.epoch = 9;
    fake_bus::put(decision);
    const std::int64_t began_us = session * 1'000'000;
    bool opened = false;
    for (int ms = 0; ms < 1'000; ms += 10) {
      (void)ask(asked(), began_us + 1'000 * ms);
      driver.mark_panel_read((kStart_us + began_us + 1'000 * ms) * 1'000);
      opened |= !reader.panel((kStart_us + began_us + 1'000 * ms) * 1'000).levels.estop_a_closed;
    }
    EXPECT_TRUE(opened) << session;
  }
}

// At 0 V a ramp ends in the tick in which it begins; the decisions after it come in the same turn.
TEST_F(LiveRobotBench, ShowsARampOrATripOfOneTickThoughLaterDecisionsCameWithIt) {
  ask({}, 10'000);
  std::uint32_t number = 0;
  for (const Mode passed : {Mode::Retract, Mode::Trip}) {
    for (const Mode mode : {Mode::Hold, passed, Mode::Safe, Mode::Ready}) {
      Decision decision;
      decision.seq = ++number;
      decision.mode = mode;
      decision.panel_unread_ms = mode == passed ? 30 : 40;
      fake_bus::put(decision);
    }
    const auto first = ask({}, 10'000 * number);
    ASSERT_TRUE(first);
    EXPECT_EQ(first->record.supervisor.permit.mode, passed);
    EXPECT_EQ(first->record.panel_unread_ms, 30);
    const auto second = ask({}, 10'000 * number + 1'000);
    ASSERT_TRUE(second);
    EXPECT_EQ(second->record.supervisor.permit.mode, Mode::Ready);
  }
}

// An edge of the drive disturbs an image for one decision.
TEST_F(LiveRobotBench, ShowsADisturbedImageThoughLaterDecisionsCameWithIt) {
  ask({}, 10'000);
  Decision decision;
  for (const bool disturbed : {false, true, false})
    ++decision.seq, decision.image_disturbed = disturbed, fake_bus::put(decision);
  EXPECT_TRUE(ask({}, 20'000)->record.supervisor.image_disturbed);
  EXPECT_FALSE(ask({}, 21'000)->record.supervisor.image_disturbed);
  ++decision.seq, fake_bus::put(decision);
  EXPECT_FALSE(ask({}, 22'000)->record.supervisor.image_disturbed) << "nothing of it came";
}

}  // namespace
}  // namespace biopsy::loops_tests
