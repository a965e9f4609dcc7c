// The watch over the links, tick by tick, at the edges of every limit.
#include <gtest/gtest.h>

#include "tests/safety/link_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

using Bench = LinkBench;

TEST(Links, AreSoundWhenEverythingIsInOrder) {
  Bench bench;
  EXPECT_EQ(bench.found, 0U) << name_of(worst_of(bench.found));
  EXPECT_TRUE(bench.tick().fresh);
}

TEST(Clocks, MayTakeStepsOfOneMicrosecondToFiveMilliseconds) {
  verifies("R-05");
  for (const std::int64_t step_us : {-1, 0, 1, 5'000, 5'001}) {
    const bool sound = step_us == 1 || step_us == 5'000;
    Bench ours, stages;
    ours.advance(), stages.advance();
    ours.seen.now_us += step_us - 1'000;
    stages.seen.measurement.time_us += step_us - 1'000;
    ours.observe(), stages.observe();
    EXPECT_EQ(ours.found, sound ? 0 : bit(Hazard::ClockJump)) << step_us;
    EXPECT_EQ(stages.names(Hazard::ClockJump), !sound) << step_us;  // periods that went by are another hazard
  }
}

TEST(Clocks, OfTheStageAreJudgedBetweenNeighbouringMeasurementsOnly) {
  Bench bench;
  bench.tick();
  bench.seen.measurement.time_us += 9'000, ++bench.seen.measurement.seq;  // one was lost
  bench.tick();
  EXPECT_FALSE(bench.names(Hazard::ClockJump));
  Bench first;
  first.watch.seq = 0, first.watch.stage_us = 0;
  first.seen.measurement.seq = 0;
  first.tick();
  EXPECT_FALSE(first.names(Hazard::ClockJump)) << "the first one has no neighbour";
}

TEST(Measurements, AreStaleAfterMoreThanThreeTicks) {
  verifies("R-18");
  Bench bench;
  const std::uint32_t last = bench.seen.measurement.seq;
  for (const bool stale : {false, false, false, true, true}) {
    bench.advance();
    bench.seen.measurement.seq = last;
    EXPECT_FALSE(bench.observe().fresh);
    EXPECT_EQ(bench.names(Hazard::SensorStale), stale);
  }
  bench.tick();
  EXPECT_FALSE(bench.names(Hazard::SensorStale));
}

TEST(Measurements, OutOfOrderAreForgivenOnceAndNotTwice) {
  verifies("R-26");
  Bench bench;
  const auto skip = [&] { ++bench.seen.measurement.seq, bench.tick(); };
  skip();
  EXPECT_FALSE(bench.names(Hazard::MessageOrder));
  EXPECT_EQ(bench.watch.order_score, 2);
  bench.tick();
  EXPECT_EQ(bench.watch.order_score, 1);
  skip();
  EXPECT_TRUE(bench.names(Hazard::MessageOrder));
  EXPECT_EQ(bench.watch.order_score, 3);
  skip();
  EXPECT_EQ(bench.watch.order_score, 4) << "bounded";
  for (int left = 3; left >= 0; --left) {
    bench.tick();
    EXPECT_EQ(bench.watch.order_score, left);
  }
  EXPECT_FALSE(bench.names(Hazard::MessageOrder));
  bench.tick();
  EXPECT_EQ(bench.watch.order_score, 0);
}

TEST(Measurements, OfARestartedStageAreTakenUpWhenItWasSilentAndTheDriveIsOff) {
  for (const auto& [mode, silent] : {std::pair{Mode::Safe, 4}, {Mode::Safe, 3}, {Mode::Hold, 4}}) {
    Bench bench;
    bench.seen.permit.mode = mode;
    bench.watch.stale_ticks = silent;
    bench.advance();
    bench.seen.measurement.seq = 1;
    EXPECT_EQ(bench.observe().fresh, mode == Mode::Safe && silent == 4);
  }
}

TEST(Answers, MayBeFivePermitsOldAndNotSix) {
  verifies("R-10");
  for (const std::uint32_t age : {0U, 1U, 5U, 6U}) {
    Bench bench;
    bench.watch.answered_seq = bench.seen.permit.seq - 8;
    bench.watch.answer_score = 1;
    bench.advance();
    bench.answer(bench.seen.permit.seq - age);
    bench.observe();
    EXPECT_EQ(bench.watch.answer_score, age == 6 ? 3 : 0) << age;
    EXPECT_EQ(bench.names(Hazard::WrongAnswer), age == 6) << age;
  }
}

TEST(Answers, OfTheSameNumberAsBeforeAreNeitherNewNorWrong) {
  verifies("R-10");
  Bench bench;
  bench.watch.answer_score = 2;
  const std::uint32_t last = bench.seen.permit.seq;
  bench.advance();
  bench.answer(last);
  bench.observe();
  EXPECT_EQ(bench.watch.answer_score, 2);
  bench.advance();
  bench.answer(last - 1);
  bench.observe();
  EXPECT_EQ(bench.watch.answer_score, 4) << "older than one already given";
  EXPECT_EQ(bench.watch.answered_seq, last);
}

TEST(Answers, ThatDoNotComeAreWrongAfterFivePermits) {
  verifies("R-10");
  Bench bench;
  const Measurement old = bench.seen.measurement;
  for (int silent = 1; silent <= 7; ++silent) {
    bench.advance();
    bench.seen.measurement = old;
    bench.observe();
    EXPECT_EQ(bench.watch.answer_score, silent < 6 ? 0 : silent == 6 ? 2 : 4) << silent;
  }
}

TEST(Answers, AreHeldAgainstTheModeOfThePermitTheyAnswer) {
  verifies("R-10");
  Bench bench;
  for (int i = 0; i < 40; ++i) {
    const Mode before = bench.seen.permit.mode;
    bench.advance();
    bench.seen.permit.mode = i % 3 == 0 ? Mode::Hold : Mode::Active;
    const Mode now = bench.seen.permit.mode;
    bench.seen.permit.mode = before;
    bench.answer(bench.seen.permit.seq - 1);
    bench.seen.permit.mode = now;
    bench.observe();
    ASSERT_FALSE(bench.names(Hazard::WrongAnswer)) << i;
    ASSERT_EQ(bench.watch.answer_score, 0) << i;
  }
}

TEST(Answers, AreAllRightUpToTheFirstPermitAndThereIsNoneBefore) {
  Bench bench;
  bench.watch.answered_seq = 0, bench.watch.answer_score = 0;
  bench.seen.permit.seq = 0;
  bench.tick();
  EXPECT_EQ(bench.watch.answered_seq, 1U) << "permit 1 was answered";
  bench.watch.answered_seq = 0;
  bench.advance();
  bench.answer(0);
  bench.observe();
  EXPECT_EQ(bench.watch.answer_score, 2) << "number 0 answers nothing";
  bench.seen.permit.seq = 0;
  bench.observe();
  EXPECT_TRUE(bench.names(Hazard::WrongAnswer));
}

TEST(Controller, IsSilentAfterMoreThanThreeMeasurementsWithoutARequest) {
  verifies("R-25");
  Bench bench;
  const DriveRequest last = bench.seen.request;
  for (const bool silent : {false, false, false, true, true}) {
    bench.advance();
    bench.seen.request = last;
    bench.observe();
    EXPECT_EQ(bench.names(Hazard::ControllerSilent), silent);
  }
  bench.tick();
  EXPECT_FALSE(bench.names(Hazard::ControllerSilent));
}

TEST(Controller, IsNotSilentWhereThereWasNothingToAnswer) {
  verifies("R-25");
  Bench bench;
  const DriveRequest last = bench.seen.request;
  const Measurement old = bench.seen.measurement;
  for (int i = 0; i < 10; ++i) {
    bench.advance();
    bench.seen.request = last, bench.seen.measurement = old;
    bench.observe();
    EXPECT_FALSE(bench.names(Hazard::ControllerSilent));
  }
}

TEST(Controller, ThatAnswersLateIsThereThoughNothingWasMeasured) {
  Bench bench;
  bench.watch.silent_ticks = 4;
  const Measurement old = bench.seen.measurement;
  bench.advance();
  bench.seen.measurement = old;
  bench.observe();
  EXPECT_FALSE(bench.names(Hazard::ControllerSilent));
}

TEST(EStop, ContactsMayDifferForTwentyTicksAndAreLatchedAtTheNext) {
  verifies("R-03", "R-04");
  for (const bool a_opens : {true, false}) {
    Bench bench;
    (a_opens ? bench.seen.estop_a_closed : bench.seen.estop_b_closed) = false;
    for (int i = 0; i < 20; ++i) {
      bench.tick();
      EXPECT_EQ(bench.found, bit(Hazard::EStop)) << i;
    }
    bench.tick();
    EXPECT_EQ(bench.found, bit(Hazard::EStop) | bit(Hazard::EStopDisagrees));
    bench.seen.estop_a_closed = bench.seen.estop_b_closed = true;
    bench.tick();
    EXPECT_EQ(bench.found, bit(Hazard::EStopDisagrees));
    bench.seen.estop_a_closed = bench.seen.estop_b_closed = false;
    bench.tick();
    EXPECT_EQ(bench.found, bit(Hazard::EStop) | bit(Hazard::EStopDisagrees));
    bench.tick();
    EXPECT_EQ(bench.found, bit(Hazard::EStop));
  }
}

TEST(EStop, ContactsThatAgreeAgainInTimeStartTheCountAnew) {
  Bench bench;
  for (int round = 0; round < 3; ++round) {
    bench.seen.estop_a_closed = false;
    for (int i = 0; i < 20; ++i) bench.tick();
    bench.seen.estop_a_closed = true;
    bench.tick();
    EXPECT_EQ(bench.found, 0U);
  }
}

TEST(Tissue, MayBeUnlikeThePlanForNinetyNineTicks) {
  verifies("R-27", "R-32");
  for (const std::int32_t residual_um : {-1, 0, 500, 501}) {
    const bool unlike = residual_um == -1 || residual_um == 501;
    Bench bench;
    bench.seen.tissue_residual_um = residual_um;
    for (int tick = 1; tick <= 1'102; ++tick) {
      bench.tick();
      ASSERT_EQ(bench.names(Hazard::SuspectTissueModel), unlike && tick >= 100) << tick;
      ASSERT_EQ(bench.names(Hazard::WrongTissueModel), unlike && tick >= 1'100) << tick;
    }
  }
}

TEST(Patient, MayMoveTwoMillimetres) {
  verifies("R-33");
  for (const std::int32_t motion_um : {-1, 0, 2'000, 2'001}) {
    Bench bench;
    bench.seen.patient_motion_um = motion_um;
    bench.tick();
    EXPECT_EQ(bench.found, motion_um == -1 || motion_um == 2'001 ? bit(Hazard::PatientMotion) : 0)
        << motion_um;
  }
}

TEST(Log, MayBeASecondBehind) {
  verifies("R-28");
  for (const std::int32_t backlog_ms : {-1, 0, 1'000, 1'001}) {
    Bench bench;
    bench.seen.log_backlog_ms = backlog_ms;
    bench.tick();
    EXPECT_EQ(bench.found, backlog_ms == -1 || backlog_ms == 1'001 ? bit(Hazard::LogBacklog) : 0)
        << backlog_ms;
  }
}

TEST(Writers, AreOne) {
  verifies("R-11");
  for (const std::int32_t writers : {-1, 0, 1, 2}) {
    Bench bench;
    bench.seen.writers = writers;
    bench.tick();
    EXPECT_EQ(bench.found, writers == 1 ? 0 : bit(Hazard::SecondWriter)) << writers;
  }
}

TEST(Seals, AreThoseOfThisPlanAndConfigurationWhetherTheirNumbersAreLargerOrSmaller) {
  verifies("R-12", "R-13", "R-30");
  for (const std::uint64_t off : {std::uint64_t{1}, ~std::uint64_t{0}}) {
    Bench plan, config, first, second;
    plan.seen.plan_tag += off, config.seen.config_tag += off;
    first.seen.confirmed_tag[0] += off, second.seen.confirmed_tag[1] += off;
    for (Bench* bench : {&plan, &config, &first, &second}) bench->tick();
    EXPECT_EQ(plan.found, bit(Hazard::PlanChanged));
    EXPECT_EQ(config.found, bit(Hazard::ConfigChanged));
    EXPECT_EQ(first.found, bit(Hazard::PlanUnconfirmed));
    EXPECT_EQ(second.found, bit(Hazard::PlanUnconfirmed));
  }
}

TEST(Seals, OfZeroAreNone) {
  verifies("R-12", "R-13", "R-30");
  Bench bench;
  bench.plan.plan_tag = bench.plan.config_tag = bench.seen.plan_tag = bench.seen.config_tag = 0;
  bench.seen.confirmed_tag = {0, 0};
  bench.tick();
  EXPECT_EQ(bench.found,
            bit(Hazard::PlanChanged) | bit(Hazard::ConfigChanged) | bit(Hazard::PlanUnconfirmed));
  bench.plan.plan_tag = bench.plan.config_tag = bench.seen.plan_tag = bench.seen.config_tag = 1;
  bench.seen.confirmed_tag = {1, 1};
  bench.tick();
  EXPECT_EQ(bench.found, 0U) << "one is a seal like any other";
}

TEST(Plan, IsJudgedAnewWhileNothingMoves) {
  verifies("R-29");
  Bench bench;
  bench.plan.depth_max_um = 4;
  bench.tick();
  EXPECT_FALSE(bench.names(Hazard::PlanImplausible)) << "in motion its tag stands for it";
  bench.seen.permit.mode = Mode::Safe;
  bench.tick();
  EXPECT_TRUE(bench.names(Hazard::PlanImplausible));
}

}  // namespace
}  // namespace biopsy::safety
