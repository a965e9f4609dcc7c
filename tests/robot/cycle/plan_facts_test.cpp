// What the supervisor keeps of a plan. The plan is made here, each of its numbers another; expected are the
// safety concept's margins and the same numbers in whole units.
#include "robot/cycle/plan_facts.hpp"

#include <gtest/gtest.h>

#include "planner/plan/seal.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::robot {
namespace {

Plan of_sizes(std::size_t steps, std::size_t bands) {
  Plan plan;
  plan.limits.depth_max = Millimetres(4.0);
  plan.target_depth = Millimetres(3.0);
  for (std::size_t i = 0; i < steps; ++i)
    plan.steps.push_back({.depth = Millimetres(1.0 + 0.01 * static_cast<double>(i)),
                          .speed = MillimetresPerSecond(1.0),
                          .v_max = Volts(3'000.0 + static_cast<double>(i)),
                          .dwell = Seconds(0.5),
                          .image_confirms = i % 2 == 1,
                          .why = ""});
  for (std::size_t i = 0; i < bands; ++i)
    plan.limits.plausible.push_back(
        {Volts(100.0 * static_cast<double>(i)), Millimetres(-0.5), Millimetres(0.5)});
  planner::seal(plan);
  return plan;
}

TEST(PlanFactsOfAPlan, AreItsNumbersInWholeUnitsWithTheMarginsOfTheSupervisor) {
  const Plan plan = of_sizes(2, 3);
  const safety::PlanFacts facts = plan_facts(plan, 77);
  EXPECT_EQ(facts.plan_tag, planner::plan_tag(plan));
  EXPECT_EQ(facts.config_tag, 77U);
  EXPECT_EQ(facts.depth_max_um, 4'000);
  EXPECT_EQ(facts.tissue_residual_max_um, 500);
  EXPECT_EQ(facts.bench_half_period_ticks, 0) << "a plan for a patient";
  ASSERT_EQ(facts.step_count, 2U);
  EXPECT_EQ(facts.steps[0].depth_max_um, 1'500) << "half a millimetre beyond the step";
  EXPECT_EQ(facts.steps[1].depth_max_um, 1'510);
  EXPECT_EQ(facts.steps[1].v_max_mV, 3'001'000);
  EXPECT_EQ(facts.steps[1].slew_up_mV_per_tick, 80'000);
  EXPECT_FALSE(facts.steps[0].image_confirms);
  EXPECT_TRUE(facts.steps[1].image_confirms);
  ASSERT_EQ(facts.band_count, 3U);
  EXPECT_EQ(facts.bands[2].drive_mV, 200'000);
  EXPECT_EQ(facts.bands[2].low_um, -500);
  EXPECT_EQ(facts.bands[2].high_um, 500);
}

// A sealed plan whose steps and depth limit have left its target behind.
TEST(PlanFactsOfAPlan, NoStepReachesAMillimetreBeyondTheTarget) {
  Plan plan = of_sizes(2, 2);
  plan.limits.depth_max = Millimetres(12.0);
  plan.steps[1].depth = Millimetres(11.5);
  const safety::PlanFacts facts = plan_facts(plan, 77);
  EXPECT_EQ(facts.depth_max_um, 4'000);
  EXPECT_EQ(facts.steps[1].depth_max_um, 4'000);
}

TEST(PlanFactsOfAPlan, NoStepReachesBeyondThePlan) {
  Plan plan = of_sizes(1, 2);
  plan.steps[0].depth = Millimetres(3.8);
  EXPECT_EQ(plan_facts(plan, 77).steps[0].depth_max_um, 4'000);
}

TEST(PlanFactsOfAPlan, HaveThePolarityRateOfABenchAndNeverThatOfAPatient) {
  Plan plan = of_sizes(1, 2);
  plan.bench = BenchDrive{.half_period = Seconds(0.125)};
  EXPECT_EQ(plan_facts(plan, 77).bench_half_period_ticks, 125);
  plan.bench->half_period = Seconds(0.0001);
  EXPECT_EQ(plan_facts(plan, 77).bench_half_period_ticks, 1);
}

TEST(PlanFactsOfAPlan, RefuseMoreThanTheSupervisorHolds) {
  const safety::PlanFacts full = plan_facts(of_sizes(safety::kMaxSteps, safety::kMaxBands), 77);
  EXPECT_EQ(full.step_count, safety::kMaxSteps);
  EXPECT_EQ(full.band_count, safety::kMaxBands);
  for (const std::size_t more : {1U, 2U}) {
    EXPECT_THROW(plan_facts(of_sizes(safety::kMaxSteps + more, 2), 77), ConfigError);
    EXPECT_THROW(plan_facts(of_sizes(2, safety::kMaxBands + more), 77), ConfigError);
  }
}

}  // namespace
}  // namespace biopsy::robot
