// Plan facts, hazard table and interlock.
#include <gtest/gtest.h>

#include "safety/challenge.hpp"
#include "safety/interlock.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

TEST(PlanFacts, AcceptTheTestPlanAndRefuseADefaultOne) {
  EXPECT_TRUE(is_plausible(three_stage_plan()));
  EXPECT_FALSE(is_plausible(PlanFacts{}));
}

TEST(PlanFacts, RefuseEveryNumberTheRobotCannotMean) {
  verifies("R-29");
  const auto spoilt = [](auto spoil) {
    PlanFacts plan = three_stage_plan();
    spoil(plan);
    return plan;
  };
  const PlanFacts bad[] = {
      spoilt([](PlanFacts& p) { p.depth_max_um = 4; }),  // millimetres for micrometres
      spoilt([](PlanFacts& p) { p.depth_max_um = limits::kStroke_um + 1; }),
      spoilt([](PlanFacts& p) { p.tissue_residual_max_um = 0; }),
      spoilt([](PlanFacts& p) { p.tissue_residual_max_um = limits::kStroke_um + 1; }),
      spoilt([](PlanFacts& p) { p.stage_count = 0; }),
      spoilt([](PlanFacts& p) { p.stage_count = kMaxSteps + 1; }),
      spoilt([](PlanFacts& p) { p.band_count = 0; }),
      spoilt([](PlanFacts& p) { p.band_count = kMaxBands + 1; }),
      spoilt([](PlanFacts& p) { p.stages[1].depth_max_um = 99; }),
      spoilt([](PlanFacts& p) { p.stages[1].depth_max_um = 4'001; }),
      spoilt([](PlanFacts& p) { p.stages[2].v_max_mV = 6'000; }),  // volts for millivolts
      spoilt([](PlanFacts& p) { p.stages[2].v_max_mV = 8'000'001; }),
      spoilt([](PlanFacts& p) { p.stages[0].slew_up_mV_per_tick = 0; }),
      spoilt([](PlanFacts& p) { p.stages[0].slew_up_mV_per_tick = 400'001; }),
      spoilt([](PlanFacts& p) { p.bands[1].drive_mV = -1; }),
      spoilt([](PlanFacts& p) { p.bands[2].drive_mV = p.bands[1].drive_mV; }),
      spoilt([](PlanFacts& p) { p.bands[1].low_um = -12'001; }),
      spoilt([](PlanFacts& p) { p.bands[1].high_um = p.bands[1].low_um - 1; }),
  };
  for (const PlanFacts& plan : bad) EXPECT_FALSE(is_plausible(plan)) << &plan - bad;
}

TEST(PlanFacts, AcceptAsManyStagesAndBandsAsThereIsRoomFor) {
  PlanFacts plan = three_stage_plan();
  plan.stage_count = kMaxSteps;
  plan.stages.fill(plan.stages[0]);
  plan.band_count = kMaxBands;
  for (std::size_t i = 0; i < kMaxBands; ++i)
    plan.bands[i] = {static_cast<std::int32_t>(i) * 250'000, -10, 10};
  EXPECT_TRUE(is_plausible(plan));
  EXPECT_EQ(plausible_depth(plan, 0, 8'000'000).high_um, 10);
}

TEST(PlanFacts, APlanInTheWrongUnitsIsNeverReady) {
  verifies("R-29");
  Rig rig;
  rig.plan.depth_max_um = 4;
  rig.run(200);
  EXPECT_EQ(rig.state.mode, Mode::Safe);
  EXPECT_NE(rig.evidence.hazards() & bit(Hazard::PlanImplausible), 0U);
}

TEST(PlanFacts, InterpolateTheBandAndHoldItsEnds) {
  const PlanFacts plan = three_stage_plan();
  EXPECT_EQ(plausible_depth(plan, 2'000'000, 6'000'000).low_um, 800);
  EXPECT_EQ(plausible_depth(plan, 2'000'000, 6'000'000).high_um, 3'350);
  EXPECT_EQ(plausible_depth(plan, 0, 8'200'000).low_um, -100);
  EXPECT_EQ(plausible_depth(plan, 0, 8'200'000).high_um, 4'400);
  EXPECT_EQ(plausible_depth(PlanFacts{}, 0, 8'000'000).high_um, 0);
}

TEST(HazardTable, NamesTheWorstOfASet) {
  EXPECT_EQ(worst_of(0), Hazard::None);
  EXPECT_EQ(worst_of(bit(Hazard::PatientMotion) | bit(Hazard::SensorStale)), Hazard::SensorStale);
  EXPECT_EQ(hazards_with(StopCategory::None), 0U);
  EXPECT_EQ(hazards_with(StopCategory::C0Off) | hazards_with(StopCategory::C1Ramp) |
                hazards_with(StopCategory::C2Hold),
            kAllHazards);
}

TEST(Interlock, OpensTwentyMillisecondsAfterEitherSideStops) {
  verifies("R-43");
  const Interlock fed = feed_from_driver(feed_from_supervisor(Interlock{}, 1'000'000), 1'005'000);
  EXPECT_FALSE(is_closed(Interlock{}, 1'000));
  EXPECT_TRUE(is_closed(fed, 1'019'999));
  EXPECT_FALSE(is_closed(fed, 1'020'000)) << "supervisor stopped";
  const Interlock supervised = feed_from_supervisor(fed, 1'020'000);
  EXPECT_TRUE(is_closed(supervised, 1'024'999));
  EXPECT_FALSE(is_closed(supervised, 1'025'000)) << "driver stopped";
  EXPECT_FALSE(is_closed(supervised, 999'999)) << "clock went back";
  EXPECT_FALSE(is_closed(feed_from_driver(Interlock{}, 1'000), 1'001)) << "supervisor never fed it";
}

TEST(Voltage, ThatAppearsWhileReadyTripsInThreeTicks) {
  verifies("R-36");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.on_measurement = [](Measurement& m) { m.monitor_mV = -150'000; };
  EXPECT_EQ(rig.ticks_until([&] { return rig.state.mode == Mode::Trip; }, 10), 3);
  EXPECT_EQ(rig.state.last_event, Event::VoltagePresent);
}

TEST(Voltage, CommandedWithoutShowingOnTheMonitorIsNotZero) {
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.on_measurement = [](Measurement& m) { m.command_mV = 150'000; };
  rig.tick();
  EXPECT_EQ(rig.state.mode, Mode::Trip);
}

TEST(Voltage, IsUnknownWhenTheStageFallsSilent) {
  verifies("R-18");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.on_measurement = [old = rig.measurement](Measurement& m) { m = old; };
  EXPECT_EQ(rig.ticks_until([&] { return rig.state.mode == Mode::Trip; }, 10), 4);
}

TEST(Polarity, BalanceIsJudgedInAHoldTooAndForgottenWhenTheDriveWasOff) {
  verifies("R-22");
  Rig rig;
  rig.on_request = [tick = 0](DriveRequest& q) mutable {  // positive in nine tenths of each period
    q.wanted_mV = (tick++ % 500 < 440 ? 1 : -1) * std::abs(q.wanted_mV);
  };
  ASSERT_TRUE(rig.go_armed());
  rig.press();
  rig.run(600);
  ASSERT_EQ(rig.state.mode, Mode::Active);
  rig.release();
  ASSERT_LE(rig.ticks_until([&] { return rig.state.mode == Mode::Hold; }, 200), 200);
  EXPECT_EQ(rig.evidence.hazards(), 0U);
  EXPECT_LE(rig.ticks_until([&] { return rig.output.worst == Hazard::PolarityStuck; }, 600), 600);
  EXPECT_EQ(rig.state.mode, Mode::Retract);
  rig.on_request = [](DriveRequest&) {};
  ASSERT_LE(rig.ticks_until([&] { return rig.state.mode == Mode::Ready; }, 400), 400);
  EXPECT_EQ(rig.state.reason, Hazard::None);
  ASSERT_TRUE(rig.go_active()) << "a new procedure starts without the old balance";
}

TEST(Polarity, AWaveWithoutAmplitudeOrOutsideActiveIsNotJudged) {
  Rig rig;
  rig.flip_ticks = 60;
  rig.wanted_mV = 900'000;
  ASSERT_TRUE(rig.go_active());
  rig.wanted_mV = 3'000'000;
  EXPECT_LE(rig.ticks_until([&] { return rig.output.worst == Hazard::WrongFrequency; }, 1'000), 400);
}

TEST(Polarity, FrequencyMayBeOffByLessThanAFifth) {
  verifies("R-23");
  for (const std::int32_t half_period : {205, 295}) {
    Rig rig;
    rig.flip_ticks = half_period;
    ASSERT_TRUE(rig.go_active());
    rig.run(3'000);
    EXPECT_EQ(rig.state.mode, Mode::Active) << half_period << name_of(rig.state.reason);
  }
  for (const std::int32_t half_period : {195, 305}) {
    Rig rig;
    rig.flip_ticks = half_period;
    ASSERT_TRUE(rig.go_armed());
    rig.press();
    EXPECT_LE(rig.ticks_until([&] { return rig.output.worst == Hazard::WrongFrequency; }, 3'000), 3'000)
        << half_period;
    EXPECT_EQ(rig.state.mode, Mode::Retract);
  }
}

TEST(Depth, IsJudgedByWhereTheNeedleWouldComeToRest) {
  verifies("R-14", "R-16");
  Rig rig;
  rig.wanted_mV = 5'000'000;
  ASSERT_TRUE(rig.go_active());
  std::int32_t seen_um = 0;
  rig.on_measurement = [&, um = 0](Measurement& m) mutable { seen_um = m.depth_um += um += 50; };  // 50 mm/s
  EXPECT_LE(rig.ticks_until([&] { return (rig.evidence.hazards() & bit(Hazard::OverDepth)) != 0; }, 40), 40);
  EXPECT_LT(seen_um, rig.plan.depth_max_um - 300) << "50 mm/s need 0.25 mm to react and 0.25 mm to stop";
}

TEST(Depth, ACodeThatStaysTheSameAtASteadyVoltageIsNotFrozen) {
  verifies("R-19");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_measurement = [old = rig.measurement](Measurement& m) {
    m.laser_code = old.laser_code, m.depth_um = old.depth_um;
  };
  rig.run(600);
  EXPECT_EQ(rig.state.mode, Mode::Active) << name_of(rig.state.reason);
}

TEST(Ramp, StartsAtThePresentVoltageAndFallsInAStraightLine) {
  verifies("R-37");
  Rig rig;
  ASSERT_TRUE(rig.go_retract());
  EXPECT_EQ(rig.output.permit.v_max_mV, 6'000'000);
  rig.run(125);
  EXPECT_EQ(rig.output.permit.v_max_mV, 3'000'000);
  EXPECT_LE(std::abs(rig.gate_state.drive_mV), 3'000'000);
  rig.run(100);
  EXPECT_EQ(rig.output.permit.v_max_mV, 600'000);
}

TEST(Challenge, NothingIsProvenBeforeTheFirstPermit) {
  verifies("R-10");
  LinkMonitor watch;
  watch.answer_score = 0;
  EXPECT_NE(update(three_stage_plan(), watch, SupervisorInputs{}).found & bit(Hazard::WrongAnswer), 0U);
}

TEST(Challenge, LostPermitsAreForgivenAslongAsTheAnswersAreRight) {
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_permit = [n = 0](Permit&) mutable { return ++n % 4 == 0; };  // three of four lost on the way
  rig.run(500);
  EXPECT_EQ(rig.state.mode, Mode::Active) << name_of(rig.state.reason);
}

TEST(Challenge, ADriverThatKeepsGivingAnOldAnswerIsFoundOut) {
  verifies("R-10");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.flip_ticks = 1'000'000;
  rig.on_measurement = [old = rig.measurement](Measurement& m) {
    m.answer = old.answer, m.answered_seq = old.answered_seq, m.command_mV = old.command_mV;
  };
  EXPECT_LE(rig.ticks_until([&] { return (rig.evidence.hazards() & bit(Hazard::WrongAnswer)) != 0; }, 20), 7);
}

TEST(Challenge, AnAnswerFromTheFutureIsWrong) {
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_measurement = [&](Measurement& m) {
    m.answered_seq += 1;
    m.answer = answer_to(challenge_of(7, m.answered_seq), m.command_mV, Mode::Active, m.answered_seq);
  };
  EXPECT_LE(rig.ticks_until([&] { return rig.output.worst == Hazard::WrongAnswer; }, 20), 3);
}

TEST(Clock, MustAdvanceByOneToFiveMillisecondsOnBothSides) {
  verifies("R-05");
  for (const std::int64_t step_us : {std::int64_t{-1'000}, std::int64_t{0}, std::int64_t{5'001}}) {
    Rig supervisor, stage;
    ASSERT_TRUE(supervisor.go_active() && stage.go_active());
    supervisor.on_observation = [&](SupervisorInputs& seen) { seen.now_us += step_us - 1'000; };
    stage.on_measurement = [&](Measurement& m) { m.time_us += step_us - 1'000; };
    supervisor.tick();
    stage.tick();
    EXPECT_EQ(supervisor.state.reason, Hazard::ClockJump) << step_us;
    EXPECT_EQ(stage.state.reason, Hazard::ClockJump) << step_us;
  }
  Rig slow;
  ASSERT_TRUE(slow.go_active());
  slow.on_observation = [](SupervisorInputs& seen) { seen.now_us += 4'000; };
  slow.tick();
  EXPECT_EQ(slow.state.mode, Mode::Active);
}

TEST(EStop, LatchesADisagreementUntilBothContactsWereSeenOpen) {
  verifies("R-04");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.on_observation = [](SupervisorInputs& seen) { seen.estop_a_closed = false; };
  rig.run(30);
  rig.on_observation = [](SupervisorInputs&) {};
  rig.run(100);
  EXPECT_EQ(rig.output.worst, Hazard::EStopDisagrees);
  rig.on_observation = [](SupervisorInputs& seen) { seen.estop_a_closed = seen.estop_b_closed = false; };
  rig.tick();
  rig.on_observation = [](SupervisorInputs&) {};
  rig.run(2);
  EXPECT_EQ(rig.output.worst, Hazard::None);
}

TEST(SimulatedRobot, ASupervisorThatDiesLeavesTheNeedleWithoutDriveInFiveMilliseconds) {
  verifies("R-44");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_permit = [](Permit&) { return false; };
  EXPECT_EQ(rig.ticks_until([&] { return !rig.gate_state.enabled; }, 100), 5);
  rig.on_permit = [](Permit&) { return true; };
  rig.run(50);
  EXPECT_EQ(rig.state.mode, Mode::Trip);
  EXPECT_EQ(rig.gate_state.drive_mV, 0);
}

TEST(SimulatedRobot, AStageThatRestartsIsTakenUpAgainOnceTheDriveIsOff) {
  Rig rig;
  ASSERT_TRUE(rig.go_trip());
  rig.on_measurement = [old = rig.measurement](Measurement& m) { m = old; };
  rig.run(10);
  rig.on_measurement = [](Measurement& m) { m.seq -= 900; };
  rig.run(600);
  EXPECT_EQ(rig.evidence.hazards(), 0U) << name_of(rig.output.worst);
  EXPECT_EQ(rig.state.mode, Mode::Trip);
}

}  // namespace
}  // namespace biopsy::safety
