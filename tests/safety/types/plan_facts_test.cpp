// The numbers of a plan at the edges of what the robot could mean, and the band between its points.
#include "safety/types/plan_facts.hpp"

#include <gtest/gtest.h>

#include "safety/types/limits.hpp"
#include "tests/safety/plan.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

template <class Change>
bool is_plausible_with(Change change) {
  PlanFacts plan = three_step_plan();
  change(plan);
  return is_plausible(plan);
}

// Accepts from `low` to `high` and nothing beside.
template <class Set>
void expect_edges(std::int32_t low, std::int32_t high, Set set) {
  for (const std::int32_t value : {low, high})
    EXPECT_TRUE(is_plausible_with([&](PlanFacts& plan) { set(plan, value); })) << value;
  for (const std::int32_t value : {low - 1, high + 1})
    EXPECT_FALSE(is_plausible_with([&](PlanFacts& plan) { set(plan, value); })) << value;
}

TEST(PlanFacts, AcceptTheTestPlanAndRefuseADefaultOne) {
  EXPECT_TRUE(is_plausible(three_step_plan()));
  EXPECT_FALSE(is_plausible(PlanFacts{}));
}

TEST(PlanFacts, RefuseAPlanWithoutStepsOrWithoutBands) {
  verifies("R-29");
  EXPECT_FALSE(is_plausible_with([](PlanFacts& plan) { plan.step_count = 0; }));
  EXPECT_FALSE(is_plausible_with([](PlanFacts& plan) { plan.band_count = 0; }));
  for (const std::int32_t half_period_ticks : {0, 250})  // the bench, too
    EXPECT_FALSE(is_plausible_with([=](PlanFacts& plan) {
      plan.bench_half_period_ticks = half_period_ticks, plan.step_count = 0, plan.depth_max_um = 400;
    }));
}

TEST(PlanFacts, PlansFillTheRoomForStepsAndBandsAndNoMore) {
  verifies("R-29");
  PlanFacts plan = three_step_plan();
  plan.steps.fill(plan.steps[1]);
  for (std::size_t i = 0; i < kMaxBands; ++i)
    plan.bands[i] = {static_cast<std::int32_t>(i) * 250'000, static_cast<std::int32_t>(i),
                     static_cast<std::int32_t>(i) * 100 + 50};
  plan.step_count = plan.band_count = 32;
  EXPECT_TRUE(is_plausible(plan));
  plan.step_count = 33;
  EXPECT_FALSE(is_plausible(plan));
  plan.step_count = 32, plan.band_count = 33;
  EXPECT_FALSE(is_plausible(plan));
  plan.band_count = 31;
  EXPECT_EQ(plausible_depth(plan, 8'200'000, 8'200'000).low_um, 30) << "the last one that counts";
}

TEST(PlanFacts, HalfPeriodOfABenchPlanIsItsOwnBetweenItsEdges) {
  verifies("R-23");
  for (const auto& [declared, held_to] :
       {std::pair{0, 250}, {49, 250}, {50, 50}, {2'500, 2'500}, {2'501, 250}}) {
    PlanFacts plan = three_step_plan();
    plan.bench_half_period_ticks = declared;
    EXPECT_EQ(half_period_ticks(plan), held_to) << declared;
    EXPECT_EQ(is_plausible(plan), declared == 0 || declared == held_to) << declared;
  }
}

TEST(PlanFacts, NumbersOfDepthAndResidualEndAtTheStroke) {
  verifies("R-29");
  const auto only_step = [](PlanFacts& plan, std::int32_t depth_um) {
    plan.step_count = 1, plan.steps[0].image_confirms = true,
    plan.steps[0].depth_max_um = plan.depth_max_um = depth_um;
  };
  expect_edges(100, 12'000, only_step);
  expect_edges(1, 12'000, [](PlanFacts& plan, std::int32_t um) { plan.tissue_residual_max_um = um; });
}

TEST(PlanFacts, NumbersOfEveryStepHaveTheirEdges) {
  verifies("R-29");
  for (const std::size_t i : {0U, 1U, 2U}) {
    expect_edges(100, 4'000, [i](PlanFacts& plan, std::int32_t um) {
      plan.bench_half_period_ticks = 250, plan.steps[i].depth_max_um = um;
    });
    expect_edges(100'000, 8'000'000, [i](PlanFacts& plan, std::int32_t mV) { plan.steps[i].v_max_mV = mV; });
    expect_edges(1'000, 400'000,
                 [i](PlanFacts& plan, std::int32_t mV) { plan.steps[i].slew_up_mV_per_tick = mV; });
  }
}

TEST(PlanFacts, NumbersOfEveryBandHaveTheirEdges) {
  verifies("R-29");
  expect_edges(0, 3'999'999, [](PlanFacts& plan, std::int32_t mV) {
    plan.bench_half_period_ticks = 250, plan.bands[0].drive_mV = mV;
  });
  expect_edges(1, 7'999'999, [](PlanFacts& plan, std::int32_t mV) { plan.bands[1].drive_mV = mV; });
  expect_edges(7'500'000, 8'200'000, [](PlanFacts& plan, std::int32_t mV) { plan.bands[2].drive_mV = mV; });
  const auto on_bench = [](PlanFacts& plan) { plan.bench_half_period_ticks = 250; };
  for (const std::size_t i : {0U, 1U, 2U}) {
    const std::int32_t high_um = three_step_plan().bands[i].high_um,
                       low_um = three_step_plan().bands[i].low_um;
    expect_edges(-12'000, high_um,
                 [=](PlanFacts& plan, std::int32_t um) { on_bench(plan), plan.bands[i].low_um = um; });
    expect_edges(low_um, 24'000,
                 [=](PlanFacts& plan, std::int32_t um) { on_bench(plan), plan.bands[i].high_um = um; });
  }
  const auto all_low = [=](PlanFacts& plan, std::int32_t um) {
    on_bench(plan), plan.bands[2].low_um = plan.bands[2].high_um = um;
  };
  expect_edges(-12'000, 24'000, all_low);
}

TEST(PlanFacts, WithAPatientTheDepthLimitEndsHalfAMillimetreBeyondTheDeepestStep) {
  verifies("R-29");
  const auto limit = [](PlanFacts& plan, std::int32_t um) { plan.depth_max_um = um; };
  expect_edges(4'000, 4'501, limit);
  expect_edges(4'000, 12'000, [&](PlanFacts& plan, std::int32_t um) {
    plan.bench_half_period_ticks = 250, limit(plan, um);
  });
  expect_edges(3'900, 4'401, [&](PlanFacts& plan, std::int32_t um) {
    plan.steps[2].depth_max_um = 3'900, limit(plan, um);
  });
}

TEST(PlanFacts, WithAPatientTheLastStepIsConfirmedByAnImage) {
  verifies("R-29");
  for (const std::uint32_t count : {1U, 2U, 3U}) {
    PlanFacts plan = three_step_plan();
    plan.step_count = count;
    plan.depth_max_um = plan.steps[count - 1].depth_max_um;
    for (std::uint32_t i = 0; i < count; ++i) plan.steps[i].image_confirms = i + 1 == count;
    EXPECT_TRUE(is_plausible(plan)) << count;
    plan.steps[count - 1].image_confirms = false;
    EXPECT_FALSE(is_plausible(plan)) << count;
    plan.bench_half_period_ticks = 250;
    EXPECT_TRUE(is_plausible(plan)) << "nobody lies on a bench";
  }
}

TEST(PlanFacts, WithAPatientNoStepGoesBack) {
  verifies("R-29");
  expect_edges(3'600, 4'000, [](PlanFacts& plan, std::int32_t um) { plan.steps[1].depth_max_um = um; });
  const auto back = [](PlanFacts& plan) { plan.steps[2].depth_max_um = 3'799; };
  EXPECT_FALSE(is_plausible_with(back));
  EXPECT_TRUE(is_plausible_with([&](PlanFacts& plan) { back(plan), plan.bench_half_period_ticks = 250; }));
}

TEST(PlanFacts, WithAPatientTheFirstBandIsThatOfTheNeedleAtRest) {
  verifies("R-29");
  for (const std::int32_t half_period_ticks : {0, 250})
    EXPECT_EQ(is_plausible_with([=](PlanFacts& plan) {
                plan.bands[0].drive_mV = 1, plan.bench_half_period_ticks = half_period_ticks;
              }),
              half_period_ticks != 0);
}

// Edges from the bands of the two models here, 0 to 300 g: 4.5 mm at rest, 16.1 mm at 3 kV, 20.8 mm at 8 kV.
TEST(PlanFacts, WithAPatientTheBandIsNarrowAtRestAndNowhereHigherThanAStageCanLift) {
  verifies("R-29");
  expect_edges(-1'000, 100, [](PlanFacts& plan, std::int32_t um) { plan.bands[0].low_um = um; });
  expect_edges(-100, 1'300, [](PlanFacts& plan, std::int32_t um) { plan.bands[0].high_um = um; });
  const auto at_rest_alone = [](PlanFacts& plan, std::int32_t um) {
    plan.bands[0].high_um = um;
    for (const std::size_t i : {1U, 2U}) plan.bands[i].low_um = plan.bands[i].high_um = 6'000;
  };
  expect_edges(-100, 5'000, at_rest_alone);
  for (const auto& [drive_mV, highest_um] : {std::pair{1'000'000, 8'800},
                                             {3'000'000, 16'400},
                                             {4'200'000, 20'960},
                                             {4'210'526, 20'999},
                                             {4'300'000, 21'000},
                                             {7'999'999, 21'000}})
    expect_edges(2'300, highest_um, [drive_mV = drive_mV](PlanFacts& plan, std::int32_t um) {
      plan.bands[1] = {drive_mV, 2'300, um}, plan.bands[2] = {8'000'000, 2'300, 21'000};
    });
  expect_edges(4'400, 21'000, [](PlanFacts& plan, std::int32_t um) {
    plan.bands[2].low_um = 4'400, plan.bands[2].high_um = um;
  });
}

// Else no standing still under a rising drive would be a fault.
TEST(PlanFacts, WithAPatientTheNeedleMayHaveLiftedByFourKilovolts) {
  verifies("R-29");
  const auto lifts_at = [](std::int32_t drive_mV) {
    return is_plausible_with([=](PlanFacts& plan) { plan.bands[1] = {drive_mV, 0, 1'100}; });
  };
  EXPECT_TRUE(lifts_at(4'000'000));
  EXPECT_FALSE(lifts_at(4'000'001));
  const auto flat = [](PlanFacts& plan) {
    for (PlausibleBand& band : plan.bands) band.low_um = -1'000, band.high_um = 5'000;
  };
  EXPECT_FALSE(is_plausible_with(flat));
  EXPECT_TRUE(is_plausible_with([&](PlanFacts& plan) { flat(plan), plan.bench_half_period_ticks = 250; }));
}

TEST(PlanFacts, WithAPatientTheBandRisesWithTheDrive) {
  verifies("R-29");
  expect_edges(-100, 2'300, [](PlanFacts& plan, std::int32_t um) { plan.bands[1].low_um = um; });
  expect_edges(1'700, 4'400, [](PlanFacts& plan, std::int32_t um) { plan.bands[1].high_um = um; });
}

TEST(PlanFacts, NumbersOfNoStepReachBeyondTheDrivesThatTheBandKnows) {
  verifies("R-29");
  for (const std::size_t i : {0U, 1U, 2U})
    for (const std::int32_t mV : {7'600'000, 7'600'001})
      EXPECT_EQ(is_plausible_with([&](PlanFacts& plan) {
                  plan.bands[2].drive_mV = 7'600'000, plan.steps[i].v_max_mV = mV;
                }),
                mV == 7'600'000)
          << i;
}

TEST(PlanFacts, NumbersOfABenchPlanWithOneStepAndOneBandAreEnough) {
  EXPECT_TRUE(is_plausible_with([](PlanFacts& plan) {
    plan.step_count = plan.band_count = 1, plan.bands[0].drive_mV = 6'500'000,
    plan.bench_half_period_ticks = 250;
  }));
}

TEST(PlanFacts, PlausibleBandGoesThroughItsPointsAndStraightBetweenThem) {
  verifies("R-21");
  const PlanFacts plan = three_step_plan();
  const auto at = [&](std::int32_t mV) {
    const DepthRange range = plausible_depth(plan, mV, mV);
    return std::pair{range.low_um, range.high_um};
  };
  EXPECT_EQ(at(-1), (std::pair{-100, 100}));
  EXPECT_EQ(at(0), (std::pair{-100, 100}));
  EXPECT_EQ(at(1'000'000), (std::pair{350, 650}));
  EXPECT_EQ(at(4'000'000), (std::pair{1'700, 2'300}));
  EXPECT_EQ(at(5'000'000), (std::pair{2'175, 2'825}));
  EXPECT_EQ(at(8'000'000), (std::pair{3'600, 4'400}));
  EXPECT_EQ(at(8'000'001), (std::pair{3'600, 4'400}));
  EXPECT_EQ(plausible_depth(plan, 1'000'000, 5'000'000).low_um, 350);
  EXPECT_EQ(plausible_depth(plan, 1'000'000, 5'000'000).high_um, 2'825);
}

TEST(PlanFacts, DriveThatLiftsIsWhereTheBandsUpperEdgeHasRisenByAMillimetre) {
  verifies("R-19");
  PlanFacts plan = three_step_plan();  // upper edge 100, 2300, 4400 um at 0, 4, 8 kV
  EXPECT_EQ(lifting_drive_mV(plan), 1'818'181);
  plan.bands[1].high_um = plan.bands[2].high_um = 1'100;
  EXPECT_EQ(lifting_drive_mV(plan), 4'000'000)
      << "a point that has risen by just that, and nothing behind it";
  plan.bands[2].high_um = 4'400;
  EXPECT_EQ(lifting_drive_mV(plan), 4'000'000);
  plan.bands[1].high_um = 1'099;
  EXPECT_NEAR(lifting_drive_mV(plan), 4'000'000 + 4e6 / 3'301, 2.0);
  plan.bands[2].high_um = 1'099;
  EXPECT_EQ(lifting_drive_mV(plan), 8'000'000) << "never: where the band ends";
  plan.band_count = 0;
  EXPECT_EQ(lifting_drive_mV(plan), 0);
  for (std::size_t i = 0; i < kMaxBands; ++i) plan.bands[i] = {static_cast<std::int32_t>(i) * 1'000, 0, 0};
  for (const std::uint32_t count : {31U, 32U, 33U, 0xFFFF'FFFFU}) {
    plan.band_count = count;
    EXPECT_EQ(lifting_drive_mV(plan), count == 31U ? 30'000 : 31'000);
  }
}

TEST(PlanFacts, PlausibleBandOfFewOrOfTooManyPointsIsReadNoFurtherThanThereAre) {
  PlanFacts plan = three_step_plan();
  plan.band_count = 0;
  EXPECT_EQ(plausible_depth(plan, 0, 4'000'000).low_um, 0);
  EXPECT_EQ(plausible_depth(plan, 0, 4'000'000).high_um, 0);
  plan.band_count = 1;
  EXPECT_EQ(plausible_depth(plan, 4'000'000, 4'000'000).high_um, 100);
  for (std::size_t i = 0; i < kMaxBands; ++i)
    plan.bands[i] = {static_cast<std::int32_t>(i) * 1'000, static_cast<std::int32_t>(i),
                     static_cast<std::int32_t>(i) + 50};
  for (const std::uint32_t count : {32U, 33U, 0xFFFF'FFFFU}) {
    plan.band_count = count;
    EXPECT_EQ(plausible_depth(plan, 99'000, 99'000).low_um, 31);
    EXPECT_EQ(plausible_depth(plan, 30'500, 30'500).high_um, 80);
  }
}

TEST(PlanFacts, PlausibleBandsHaveToRiseAndAreReadFromTheFirstWhereTheyDoNot) {
  verifies("R-21", "R-29");
  PlanFacts plan = three_step_plan();
  plan.bands[1].drive_mV = 8'100'000;
  EXPECT_FALSE(is_plausible(plan)) << "falling";
  plan.bands[0] = {1'000'000, 5, 6};
  EXPECT_EQ(plausible_depth(plan, 0, 0).low_um, 5) << "below the first";
  plan.bands[1] = {4'000'000, 10, 20}, plan.bands[2] = {4'000'000, 70, 80};
  EXPECT_EQ(plausible_depth(plan, 4'000'000, 4'000'000).high_um, 20) << "two at one drive";
}

TEST(PlanFacts, PlausibleBandsBeyondTheStrokeAreReadAsItsEnds) {
  verifies("R-21");
  PlanFacts plan = three_step_plan();
  for (const std::int32_t beyond_um : {-1, 0, 1, 1'000'000'000}) {
    plan.bands[0] = {0, -12'000 - beyond_um, 24'000 + beyond_um};
    const DepthRange range = plausible_depth(plan, 0, 0);
    EXPECT_EQ(range.low_um, beyond_um < 0 ? -11'999 : -12'000);
    EXPECT_EQ(range.high_um, beyond_um < 0 ? 23'999 : 24'000);
  }
}

}  // namespace
}  // namespace biopsy::safety
