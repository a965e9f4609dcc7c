// Numbers as they come over wires and out of memories: one off, below zero, at the ends of their types.
#include <gtest/gtest.h>

#include <limits>

#include "safety/monitors/clock_step.hpp"
#include "safety/monitors/debounce.hpp"
#include "safety/monitors/tissue_monitor.hpp"
#include "safety/types/plan_facts.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

constexpr std::int64_t kFirst_us = std::numeric_limits<std::int64_t>::min(),
                       kLast_us = std::numeric_limits<std::int64_t>::max();

TEST(ClockStep, IsAheadByLessThanALimitAndNeverBehind) {
  verifies("R-05");
  EXPECT_TRUE(is_less_than_after(5, 5, 1));
  EXPECT_FALSE(is_less_than_after(5, 5, 0));
  EXPECT_FALSE(is_less_than_after(5, 5, -1)) << "nothing is less than nothing after";
  EXPECT_TRUE(is_less_than_after(5, 6, 2));
  EXPECT_FALSE(is_less_than_after(5, 6, 1));
  EXPECT_FALSE(is_less_than_after(5, 4, 10));
  EXPECT_TRUE(is_less_than_after(kFirst_us, kFirst_us + 1, 2));
  EXPECT_FALSE(is_less_than_after(kFirst_us, kLast_us, kLast_us)) << "all of time lies between";
  EXPECT_FALSE(is_less_than_after(kLast_us, kFirst_us, 2)) << "a clock that ran over its end";
}

TEST(ClockStep, OfASoundClockIsOneMicrosecondToFiveMilliseconds) {
  verifies("R-05");
  for (const std::int64_t step_us : {-1, 0, 1, 5'000, 5'001})
    EXPECT_EQ(is_sound_step(700, 700 + step_us), step_us == 1 || step_us == 5'000) << step_us;
  EXPECT_FALSE(is_sound_step(kLast_us, kFirst_us));
}

TEST(Answers, OneAboveOrBelowTheRightOneAreWrong) {
  verifies("R-10");
  for (const std::uint32_t off : {1U, ~0U}) {
    Rig rig;
    ASSERT_TRUE(rig.go_ready());
    rig.run(10);
    rig.on_measurement = [off](Measurement& m) { m.answer += off; };
    const auto is_wrong = [&] { return (rig.evidence.hazards() & bit(Hazard::WrongAnswer)) != 0; };
    rig.tick();
    EXPECT_FALSE(is_wrong()) << "one slip is forgiven";
    EXPECT_LE(rig.ticks_until(is_wrong, 2), 2);
  }
}

TEST(Permits, NumberedZeroAreNoneAndAreNotAnswered) {
  verifies("R-10");
  Permit permit;
  permit.session = 9, permit.challenge = 77;
  const GateResult result = gate(GateState{}, nullptr, &permit, 1'000'000, 1);
  EXPECT_EQ(result.verdict, GateVerdict::NoPermit);
  EXPECT_EQ(result.answer, 0U);
  EXPECT_EQ(result.answered_seq, 0U);
}

TEST(BenchPlan, IsEveryPlanWithAHalfPeriodOfItsOwnEvenOneBelowZero) {
  verifies("R-29", "R-30");
  for (const std::int32_t half_period_ticks : {-1, 100}) {
    Rig rig;
    rig.plan.bench_half_period_ticks = half_period_ticks;
    rig.run(50);
    const HazardSet implausible = when(half_period_ticks < 0, Hazard::PlanImplausible);
    EXPECT_EQ(rig.evidence.hazards(), implausible | bit(Hazard::PlanUnconfirmed)) << half_period_ticks;
  }
}

TEST(Plans, FillTheRoomForStagesAndBandsAndNoMore) {
  verifies("R-29");
  PlanFacts plan = three_stage_plan();
  plan.stages.fill(plan.stages[0]);
  for (std::size_t i = 0; i < kMaxBands; ++i)
    plan.bands[i] = {static_cast<std::int32_t>(i) * 250'000, static_cast<std::int32_t>(i),
                     static_cast<std::int32_t>(i) + 50};
  plan.stage_count = plan.band_count = 32;
  EXPECT_TRUE(is_plausible(plan));
  plan.stage_count = 33;
  EXPECT_FALSE(is_plausible(plan));
  plan.stage_count = 32, plan.band_count = 33;
  EXPECT_FALSE(is_plausible(plan));
  plan.band_count = 31;
  EXPECT_EQ(plausible_depth(plan, 8'200'000, 8'200'000).low_um, 30) << "the last one that counts";
}

TEST(PlausibleBands, HaveToRiseAndAreReadFromTheFirstWhereTheyDoNot) {
  verifies("R-21", "R-29");
  PlanFacts plan = three_stage_plan();
  plan.bands[1].drive_mV = 8'100'000;
  EXPECT_FALSE(is_plausible(plan)) << "falling";
  plan.bands[0] = {1'000'000, 5, 6};
  EXPECT_EQ(plausible_depth(plan, 0, 0).low_um, 5) << "below the first";
  plan.bands[1] = {4'000'000, 10, 20}, plan.bands[2] = {4'000'000, 70, 80};
  EXPECT_EQ(plausible_depth(plan, 4'000'000, 4'000'000).high_um, 20) << "two at one drive";
}

TEST(PlausibleBands, BeyondTheStrokeAreReadAsItsEnds) {
  verifies("R-21");
  PlanFacts plan = three_stage_plan();
  for (const std::int32_t beyond_um : {-1, 0, 1, 1'000'000'000}) {
    plan.bands[0] = {0, -12'000 - beyond_um, 24'000 + beyond_um};
    const DepthRange range = plausible_depth(plan, 0, 0);
    EXPECT_EQ(range.low_um, beyond_um < 0 ? -11'999 : -12'000);
    EXPECT_EQ(range.high_um, beyond_um < 0 ? 23'999 : 24'000);
  }
}

TEST(TissueMonitor, CutsADepthAtAMetreAndADriveAtItsLimit) {
  verifies("R-27", "R-32");
  for (const std::int32_t sign : {1, -1}) {
    TissueMonitor watch;
    Measurement m;
    m.command_mV = sign * 9'000'000;
    m.depth_um = sign * 2'000'000;
    EXPECT_EQ(tissue_residual_um(three_stage_plan(), watch, m), sign > 0 ? 999'892 : 999'907);
    EXPECT_EQ(watch.mean_drive_mV, 15'625);
  }
}

}  // namespace
}  // namespace biopsy::safety
