// What a cycle in lockstep can get wrong: the order of a tick, which clock, message, tag and count reaches
// which of its three functions, and the relay between them. The stage is ideal: its monitor shows what was
// written, its needle is where the test puts it.
#include "robot/cycle/run_cycle.hpp"

#include <gtest/gtest.h>

#include "tests/robot/cycle/ideal_cycle.hpp"

namespace biopsy::robot {
namespace {

struct RunCycle : testing::Test {
  RunCycle() { cycle.wrap(watch); }

  static std::array<std::uint64_t, 2> confirmed(const Plan& plan) {
    return {planner::plan_tag(plan), planner::plan_tag(plan)};
  }
  CycleRecord run(const OperatorInputs& inputs = OperatorInputs::idle(),
                  const Environment& environment = Environment::healthy()) {
    return cycle.run(inputs, environment, [this](const Measurement& measured, const auto& decided) {
      if (watch.order != nullptr) watch.order->emplace_back("control");
      seen_measurement = measured, seen_decision = decided;
      DriveRequest request = asked;
      request.seq = ++seq;
      return request;
    });
  }
  // Runs until the robot is in `mode`; how many ticks that took, most where it never was.
  int ticks_until(Mode mode, const OperatorInputs& inputs) {
    constexpr int kMost = 3'000;
    int ticks = 0;
    while (cycle.mode() != mode && ticks < kMost) run(inputs), ++ticks;
    return ticks < kMost ? ticks : kMost;
  }
  // Armed with the key, then the button is held.
  void go() {
    OperatorInputs inputs = OperatorInputs::idle();
    ticks_until(Mode::Ready, inputs);
    inputs.arm = true;
    ticks_until(Mode::Armed, inputs);
    inputs = held();
    ticks_until(Mode::Active, inputs);
    ASSERT_EQ(cycle.mode(), Mode::Active);
  }
  static OperatorInputs held() {
    OperatorInputs inputs = OperatorInputs::idle();
    inputs.press = {1, true};
    return inputs;
  }

  const Plan plan = plan_of_two_steps();
  const safety::PlanFacts facts = plan_facts(plan, kConfigOfCycle);
  IdealStage stage;
  Watch watch;
  ControlCycle cycle{plan, facts, stage, confirmed(plan)};
  DriveRequest asked;
  std::uint32_t seq = 0;
  Measurement seen_measurement;
  safety::SupervisorOutput seen_decision;
};

TEST_F(RunCycle, MeasuresDecidesAsksAndDrivesOnceATickInThisOrder) {
  Order order;
  stage.order = watch.order = &order;
  run();
  EXPECT_EQ(order, (Order{"read", "supervise", "control", "gate", "write"}));
  EXPECT_EQ(cycle.ticks(), 1);
  run();
  EXPECT_EQ(order.size(), 10U);
  EXPECT_EQ(cycle.ticks(), 2);
}

TEST_F(RunCycle, RecordsWhatTheEmergencyStopWasFoundFor) {
  EXPECT_EQ(run().panel_unread_ms, kNotYetSeenReleased);
  OperatorInputs pressed = OperatorInputs::idle();
  pressed.estop_closed = false;
  EXPECT_EQ(run(pressed).panel_unread_ms, kSeenPressed);
}

TEST_F(RunCycle, ATickIsAMillisecondOfOneClockForSupervisorAndGate) {
  for (std::int64_t tick = 1; tick < 5; ++tick) {
    run();
    EXPECT_EQ(watch.supervised.now_us, tick * 1'000);
    EXPECT_EQ(watch.gated.now_us, tick * 1'000);
  }
}

TEST_F(RunCycle, TheSupervisorGetsWhatWasMeasuredInTheTickAndAskedForInTheLast) {
  asked.wanted_mV = 1'234;
  const CycleRecord first = run();
  EXPECT_EQ(watch.supervised.measurement, first.measurement);
  EXPECT_EQ(watch.supervised.request.seq, 0U) << "nothing was asked for yet";
  const CycleRecord second = run();
  EXPECT_EQ(second.measurement.seq, first.measurement.seq + 1);
  EXPECT_EQ(watch.supervised.measurement, second.measurement);
  EXPECT_EQ(watch.supervised.request, first.request);
  EXPECT_EQ(watch.supervised.permit, first.supervisor.permit);
  EXPECT_EQ(first.request.wanted_mV, 1'234);
}

TEST_F(RunCycle, TheControllerGetsMeasurementAndDecisionOfTheTickAndTheGateItsAnswer) {
  run();
  asked.wanted_mV = 4'321;
  const CycleRecord record = run();
  EXPECT_EQ(seen_measurement, record.measurement);
  EXPECT_EQ(seen_decision.permit, record.supervisor.permit);
  EXPECT_EQ(watch.gated.permit, record.supervisor.permit);
  EXPECT_EQ(watch.gated.request, record.request);
  EXPECT_EQ(record.request.seq, seq);
  EXPECT_EQ(record.request.wanted_mV, 4'321);
}

// Whatever a controller says of itself: in lockstep it runs the plan and configuration of the cycle.
TEST_F(RunCycle, RequestsCarryThePlanAndConfigurationOfTheCycle) {
  asked.plan_tag = 1, asked.plan_seal = {3}, asked.config_tag = 2;
  for (int tick = 0; tick < 2; ++tick) {
    const CycleRecord record = run();
    EXPECT_EQ(record.request.plan_tag, planner::plan_tag(plan));
    EXPECT_EQ(record.request.plan_seal, planner::seal_of(plan));
    EXPECT_EQ(record.request.config_tag, kConfigOfCycle);
    EXPECT_EQ(record.measurement.config_tag, kConfigOfCycle);
    EXPECT_EQ(watch.supervised.plan_tag, planner::plan_tag(plan)) << "in the first tick too";
    EXPECT_EQ(watch.supervised.config_tag, kConfigOfCycle);
  }
}

TEST_F(RunCycle, WhatTheOperatorDoesArrivesInTheTick) {
  OperatorInputs inputs;
  inputs.stop = StopCategory::C1Ramp;
  inputs.press = {7, true};
  inputs.acquiring = false;
  inputs.patient_motion_um = 321;
  inputs.remote_arm = true;
  run(inputs);
  EXPECT_EQ(watch.supervised.stop, StopCategory::C1Ramp);
  EXPECT_EQ(watch.supervised.motion.token, 7U);
  EXPECT_TRUE(watch.supervised.motion.held);
  EXPECT_FALSE(watch.supervised.acquiring);
  EXPECT_EQ(watch.supervised.patient_motion_um, 321);
  EXPECT_TRUE(watch.supervised.remote_arm);
  EXPECT_FALSE(watch.supervised.estop_a_closed);
  inputs.remote_arm = false;
  run(inputs);
  EXPECT_FALSE(watch.supervised.remote_arm);
  EXPECT_EQ(watch.supervised.motion.token, 7U) << "sent anew in each tick";
}

TEST_F(RunCycle, TheKeysAreReadInEveryTick) {
  OperatorInputs inputs = OperatorInputs::idle();
  inputs.arm = inputs.bench_confirmed = true;
  for (int tick = 0; tick < safety::kContact_ticks; ++tick) run(inputs);
  EXPECT_TRUE(watch.supervised.panel_read);
  EXPECT_TRUE(watch.supervised.local_arm);
  EXPECT_TRUE(watch.supervised.bench_confirmed);
  EXPECT_FALSE(watch.supervised.local_reset);
  EXPECT_TRUE(watch.supervised.estop_a_closed && watch.supervised.estop_b_closed);
}

TEST_F(RunCycle, TheVerdictOnAnImageIsOfThisPlan) {
  OperatorInputs inputs = OperatorInputs::idle();
  for (int tick = 0; tick < 6; ++tick) run(inputs);
  inputs.depth_accepted = true, inputs.accepted_step = 1;
  inputs.accepted_session = 5, inputs.accepted_since_seq = 6;
  run(inputs);
  EXPECT_TRUE(watch.supervised.depth_accepted);
  EXPECT_EQ(watch.supervised.accepted_step, 1U);
  EXPECT_EQ(watch.supervised.accepted_session, 5U);
  EXPECT_EQ(watch.supervised.accepted_since_seq, 6U);
}

TEST_F(RunCycle, LogAndWritersAreThoseOfTheSurroundings) {
  run(OperatorInputs::idle(), {.log_backlog_ms = 40, .writers = 3});
  EXPECT_EQ(watch.supervised.log_backlog_ms, 40);
  EXPECT_EQ(watch.supervised.writers, 3);
  EXPECT_EQ(watch.gated.writers, 3);
}

TEST_F(RunCycle, BeginsTheFirstSessionTestedAndConfirmed) {
  const CycleRecord record = run();
  EXPECT_EQ(record.supervisor.permit.session, 1U);
  EXPECT_EQ(watch.supervised.self_test, safety::SelfTest::Passed);
  EXPECT_EQ(watch.supervised.confirmed_tag, confirmed(plan));
  EXPECT_EQ(record.supervisor.permit.plan_tag, planner::plan_tag(plan));
  EXPECT_EQ(cycle.plan_facts().plan_tag, facts.plan_tag);
  EXPECT_LT(ticks_until(Mode::Ready, OperatorInputs::idle()), 3'000) << "nobody needs to test the panel";
}

// Of a plan that was changed after it was sealed the seal is what it was; the content has another tag.
TEST_F(RunCycle, APlanThatWasChangedAfterItsSealIsNotTheOneThatWasConfirmed) {
  Plan changed = plan;
  changed.target_depth = Millimetres(2.9);
  ControlCycle other(changed, facts, stage, confirmed(plan));
  other.wrap(watch);
  for (int tick = 0; tick < 100; ++tick)
    other.run(OperatorInputs::idle(), Environment::healthy(),
              [](const Measurement& m, const auto&) { return DriveRequest{.seq = m.seq}; });
  EXPECT_NE(watch.supervised.plan_tag, planner::plan_tag(plan));
  EXPECT_NE(watch.supervised.plan_tag, 0U);
  EXPECT_NE(other.mode(), Mode::Ready);
}

TEST_F(RunCycle, RecordsWhatTheMonitorsFoundAndWhatTheSupervisorDecided) {
  const CycleRecord quiet = run();
  EXPECT_EQ(quiet.evidence.clear, watch.decided.clear);
  EXPECT_NE(quiet.evidence.clear & safety::bit(safety::Hazard::Arc), 0U);
  watch.trip = true;
  EXPECT_EQ(run().evidence.clear & safety::bit(safety::Hazard::Arc), 0U);
}

TEST_F(RunCycle, RecordsWhatIsOnTheConverterFromTheEndOfTheTick) {
  go();
  asked.wanted_mV = 60'000;
  stage.most_mV = 50'000;
  const CycleRecord record = run(held());
  EXPECT_EQ(record.drive_mV, 50'000) << "what the driver wrote";
  EXPECT_EQ(record.measurement.command_mV, 0) << "what it measured before";
  EXPECT_EQ(run(held()).measurement.command_mV, 50'000);
}

TEST_F(RunCycle, TheRelayClosesOnceBothSidesFedItAndIsReadBackInTheNextTick) {
  bool driver_fed = false;  // the gate feeds its half from the first permit that is not of the boot on
  for (int tick = 0; tick < 3'000 && cycle.mode() != Mode::Ready; ++tick) {
    const CycleRecord record = run();
    EXPECT_TRUE(driver_fed || !watch.supervised.relay_closed);
    driver_fed = driver_fed || record.supervisor.permit.mode != Mode::Boot;
  }
  run();
  EXPECT_TRUE(watch.supervised.relay_closed);
}

TEST_F(RunCycle, TheRelayStaysOpenWhileOneSideFeedsItAlone) {
  watch.loses_permit = true;  // the gate has none, so the driver's half is not fed
  for (int tick = 0; tick < 50; ++tick) {
    EXPECT_TRUE(run().supervisor.interlock_pulse);
    EXPECT_FALSE(watch.supervised.relay_closed);
  }
}

// 20 ms after the last pulse of the side that stopped; the driver's half is fed while a permit lives, 5 ms.
TEST_F(RunCycle, TheRelayOpensWhenOneSideStopsFeedingIt) {
  for (const bool supervisor_stops : {false, true}) {
    Watch other;
    IdealStage fresh;
    ControlCycle one(plan, facts, fresh, confirmed(plan));
    one.wrap(other);
    std::uint32_t number = 0;
    const auto turn = [&](const OperatorInputs& inputs) {
      return one.run(inputs, Environment::healthy(),
                     [&](const Measurement&, const auto&) { return DriveRequest{.seq = ++number}; });
    };
    OperatorInputs inputs = OperatorInputs::idle();
    for (int tick = 0; tick < 3'000 && one.mode() != Mode::Ready; ++tick) turn(inputs);
    inputs.arm = true;
    for (int tick = 0; tick < 3'000 && one.mode() != Mode::Armed; ++tick) turn(inputs);
    turn(inputs), turn(inputs);
    ASSERT_TRUE(other.supervised.relay_closed);
    (supervisor_stops ? other.trip : other.loses_permit) = true;
    int closed = 0;
    for (int tick = 0; tick < 60; ++tick) turn(inputs), closed += other.supervised.relay_closed ? 1 : 0;
    EXPECT_EQ(closed, supervisor_stops ? 19 : 19 + 5) << supervisor_stops;
  }
}

TEST_F(RunCycle, WithoutHooksItDoesTheSame) {
  IdealStage bare;
  ControlCycle other(plan, facts, bare, confirmed(plan));
  std::uint32_t number = 0;
  for (int tick = 0; tick < 50; ++tick) {
    const CycleRecord one = run();
    const CycleRecord two =
        other.run(OperatorInputs::idle(), Environment::healthy(),
                  [&](const Measurement&, const auto&) { return DriveRequest{.seq = ++number}; });
    EXPECT_EQ(one.measurement, two.measurement);
    EXPECT_EQ(one.supervisor.permit, two.supervisor.permit);
    EXPECT_EQ(one.request, two.request);
  }
}

}  // namespace
}  // namespace biopsy::robot
