// The link monitor, tick by tick, at the edges of every limit.
#include <gtest/gtest.h>

#include "tests/safety/monitor_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

TEST(LinkMonitor, LinksAreSoundWhenEverythingIsInOrder) {
  LinkBench bench;
  EXPECT_EQ(bench.found, 0U) << name_of(worst_of(bench.found));
  EXPECT_TRUE(bench.tick().fresh);
}

TEST(LinkMonitor, ClocksMayTakeStepsOfOneMicrosecondToFiveMilliseconds) {
  verifies("R-05");
  for (const std::int64_t step_us : {-1, 0, 1, 5'000, 5'001}) {
    const bool sound = step_us == 1 || step_us == 5'000;
    LinkBench ours, stages;
    ours.advance(), stages.advance();
    ours.seen.now_us += step_us - 1'000;
    stages.seen.measurement.time_us += step_us - 1'000;
    ours.observe(), stages.observe();
    EXPECT_EQ(ours.found, sound ? 0 : bit(Hazard::ClockJump)) << step_us;
    EXPECT_EQ(stages.names(Hazard::ClockJump), !sound) << step_us;  // periods that went by are another hazard
  }
}

TEST(LinkMonitor, ClocksOfTheStageAreJudgedBetweenNeighbouringMeasurementsOnly) {
  LinkBench bench;
  bench.tick();
  bench.seen.measurement.time_us += 9'000, ++bench.seen.measurement.seq;  // one was lost
  bench.tick();
  EXPECT_FALSE(bench.names(Hazard::ClockJump));
  LinkBench first;
  first.monitor.seq = 0, first.monitor.stage_us = 0;
  first.seen.measurement.seq = 0;
  first.tick();
  EXPECT_FALSE(first.names(Hazard::ClockJump)) << "the first one has no neighbour";
}

TEST(LinkMonitor, MeasurementsAreStaleAfterMoreThanThreeTicks) {
  verifies("R-18");
  LinkBench bench;
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

TEST(LinkMonitor, MeasurementsOutOfOrderAreForgivenOnceAndNotTwice) {
  verifies("R-26");
  LinkBench bench;
  const auto skip = [&] { ++bench.seen.measurement.seq, bench.tick(); };
  skip();
  EXPECT_FALSE(bench.names(Hazard::MessageOrder));
  EXPECT_EQ(bench.monitor.order_score, 2);
  bench.tick();
  EXPECT_EQ(bench.monitor.order_score, 1);
  skip();
  EXPECT_TRUE(bench.names(Hazard::MessageOrder));
  EXPECT_EQ(bench.monitor.order_score, 3);
  skip();
  EXPECT_EQ(bench.monitor.order_score, 4) << "bounded";
  for (int left = 3; left >= 0; --left) {
    bench.tick();
    EXPECT_EQ(bench.monitor.order_score, left);
  }
  EXPECT_FALSE(bench.names(Hazard::MessageOrder));
  bench.tick();
  EXPECT_EQ(bench.monitor.order_score, 0);
}

TEST(LinkMonitor, MeasurementsOfARestartedStageAreTakenUpWhenItWasSilentAndTheDriveIsOff) {
  for (const auto& [mode, silent] : {std::pair{Mode::Safe, 4}, {Mode::Safe, 3}, {Mode::Hold, 4}}) {
    LinkBench bench;
    bench.seen.permit.mode = mode;
    bench.monitor.stale_ticks = silent;
    bench.advance();
    bench.seen.measurement.seq = 1;
    EXPECT_EQ(bench.observe().fresh, mode == Mode::Safe && silent == 4);
  }
}

TEST(LinkMonitor, ControllerIsSilentAfterMoreThanThreeMeasurementsWithoutARequest) {
  verifies("R-25");
  LinkBench bench;
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

TEST(LinkMonitor, ControllerIsNotSilentWhereThereWasNothingToAnswer) {
  verifies("R-25");
  LinkBench bench;
  const DriveRequest last = bench.seen.request;
  const Measurement old = bench.seen.measurement;
  for (int i = 0; i < 10; ++i) {
    bench.advance();
    bench.seen.request = last, bench.seen.measurement = old;
    bench.observe();
    EXPECT_FALSE(bench.names(Hazard::ControllerSilent));
  }
}

TEST(LinkMonitor, ControllerThatAnswersLateIsThereThoughNothingWasMeasured) {
  LinkBench bench;
  bench.monitor.silent_ticks = 4;
  const Measurement old = bench.seen.measurement;
  bench.advance();
  bench.seen.measurement = old;
  bench.observe();
  EXPECT_FALSE(bench.names(Hazard::ControllerSilent));
}

TEST(LinkMonitor, TissueMayBeUnlikeThePlanForNinetyNineTicks) {
  verifies("R-27", "R-32");
  for (const std::int32_t residual_um : {-1, 0, 500, 501}) {
    const bool unlike = residual_um == -1 || residual_um == 501;
    LinkBench bench;
    bench.seen.tissue_residual_um = residual_um;
    for (int tick = 1; tick <= 1'102; ++tick) {
      bench.tick();
      ASSERT_EQ(bench.names(Hazard::SuspectTissueModel), unlike && tick >= 100) << tick;
      ASSERT_EQ(bench.names(Hazard::WrongTissueModel), unlike && tick >= 1'100) << tick;
    }
  }
}

TEST(LinkMonitor, PatientMotionLogAndWritersHaveTheirLimits) {
  verifies("R-11", "R-28", "R-33");
  struct Limit {
    std::int32_t SupervisorInputs::*value;
    Hazard hazard;
    std::int32_t low, high;
  };
  for (const Limit& limit : {Limit{&SupervisorInputs::patient_motion_um, Hazard::PatientMotion, 0, 2'000},
                             Limit{&SupervisorInputs::log_backlog_ms, Hazard::LogBacklog, 0, 1'000},
                             Limit{&SupervisorInputs::writers, Hazard::SecondWriter, 1, 1}})
    for (const std::int32_t value : {-1, limit.low - 1, limit.low, limit.high, limit.high + 1}) {
      LinkBench bench;
      bench.seen.*limit.value = value;
      bench.tick();
      const bool sound = value >= limit.low && value <= limit.high;
      EXPECT_EQ(bench.found, sound ? 0 : bit(limit.hazard)) << name_of(limit.hazard) << ' ' << value;
    }
}

TEST(LinkMonitor, SealsAreThoseOfThisPlanAndConfigurationWhetherTheirNumbersAreLargerOrSmaller) {
  verifies("R-12", "R-13", "R-30");
  for (const std::uint64_t off : {std::uint64_t{1}, ~std::uint64_t{0}}) {
    LinkBench plan, config, first, second;
    plan.seen.plan_tag += off, config.seen.config_tag += off;
    first.seen.confirmed_tag[0] += off, second.seen.confirmed_tag[1] += off;
    for (LinkBench* bench : {&plan, &config, &first, &second}) bench->tick();
    EXPECT_EQ(plan.found, bit(Hazard::PlanChanged));
    EXPECT_EQ(config.found, bit(Hazard::ConfigChanged));
    EXPECT_EQ(first.found, bit(Hazard::PlanUnconfirmed));
    EXPECT_EQ(second.found, bit(Hazard::PlanUnconfirmed));
  }
}

TEST(LinkMonitor, SealsOfZeroAreNone) {
  verifies("R-12", "R-13", "R-30");
  LinkBench bench;
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

TEST(LinkMonitor, PlanIsJudgedAnewWhileNothingMoves) {
  verifies("R-29");
  LinkBench bench;
  bench.plan.depth_max_um = 4;
  bench.tick();
  EXPECT_FALSE(bench.names(Hazard::PlanImplausible)) << "in motion its tag stands for it";
  bench.seen.permit.mode = Mode::Safe;
  bench.tick();
  EXPECT_TRUE(bench.names(Hazard::PlanImplausible));
}

TEST(LinkMonitor, ControllerMayMissTwoPeriodsWithinAHundredTicksAndNotThree) {
  verifies("R-24");
  LinkBench bench;
  const auto miss = [&](std::uint32_t periods) { bench.seen.request.overruns += periods, bench.tick(); };
  miss(2);
  EXPECT_FALSE(bench.names(Hazard::LoopOverrun));
  EXPECT_EQ(bench.monitor.miss_score, 199);
  miss(1);
  EXPECT_TRUE(bench.names(Hazard::LoopOverrun));
  EXPECT_EQ(bench.monitor.miss_score, 298);
  miss(2);
  EXPECT_EQ(bench.monitor.miss_score, 399) << "bounded";
  LinkBench three;
  three.seen.request.overruns += 3, three.tick();
  EXPECT_EQ(three.monitor.miss_score, 399);
  LinkBench slow;
  slow.monitor.miss_score = 1;
  slow.tick();
  EXPECT_EQ(slow.monitor.miss_score, 0);
  slow.tick();
  EXPECT_EQ(slow.monitor.miss_score, 0);
}

TEST(LinkMonitor, StageMayLeaveOutPeriodsTwiceWithinAHundredTicksAndNotThreeTimes) {
  verifies("R-24");
  const auto step = [](LinkBench& bench, std::int64_t step_us) {
    bench.seen.measurement.time_us += step_us - 1'000, bench.seen.now_us += step_us - 1'000;
    bench.tick();
  };
  const auto score_after = [&](std::int64_t step_us) {
    LinkBench bench;
    step(bench, step_us);
    return bench.monitor.miss_score;
  };
  EXPECT_EQ(score_after(1), 0);
  EXPECT_EQ(score_after(1'749), 0) << "late, and the next tick still had its own period";
  EXPECT_EQ(score_after(1'750), 99);
  EXPECT_EQ(score_after(5'000), 99) << "one stall, however long: that is R-18's";
  EXPECT_EQ(score_after(5'001), 0) << "a jump of the clock says nothing of periods";
  LinkBench bench;
  for (int i = 0; i < 2; ++i) step(bench, 2'000);
  EXPECT_FALSE(bench.names(Hazard::LoopOverrun));
  step(bench, 2'000);
  EXPECT_TRUE(bench.names(Hazard::LoopOverrun)) << "500 Hz";
}

TEST(LinkMonitor, StageMissesNoPeriodByALostMessageOrBeforeItsFirst) {
  verifies("R-24");
  LinkBench lost;
  ++lost.seen.measurement.seq, lost.seen.measurement.time_us += 2'000;
  lost.tick();
  EXPECT_EQ(lost.monitor.miss_score, 0) << "the loss is counted where messages are";
  LinkBench first;
  first.monitor.seq = 0, first.seen.measurement.seq = 0, first.seen.measurement.time_us += 3'000;
  first.tick();
  EXPECT_EQ(first.monitor.miss_score, 0);
}

TEST(LinkMonitor, ControllerCountsItsFirstRequestAsTheBeginning) {
  LinkBench bench;
  bench.monitor.request_seq = 0;
  bench.seen.request.overruns = 50;
  bench.tick();
  EXPECT_EQ(bench.monitor.miss_score, 0);
  EXPECT_EQ(bench.monitor.overruns, 50U);
  bench.monitor.request_seq = bench.seen.request.seq = 1, bench.seen.request.overruns = 52;
  bench.tick();
  EXPECT_EQ(bench.monitor.miss_score, 199) << "after number 1 it counts";
}

}  // namespace
}  // namespace biopsy::safety
