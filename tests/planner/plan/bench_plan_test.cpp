#include "planner/plan/bench_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "planner/plan/nominal_model.hpp"
#include "planner/plan/seal.hpp"
#include "safety/types/limits.hpp"

namespace biopsy::planner {
namespace {

BenchRequest request_for(double volts, double grams = 50.0, double half_period_s = 0.25) {
  return {"a run", Grams(grams), Volts(volts), Seconds(half_period_s)};
}

Plan planned(const BenchRequest& request) {
  return std::get<Plan>(plan_bench(request));
}

bool refused(const BenchRequest& request) {
  const auto answer = plan_bench(request);
  const auto* refusal = std::get_if<PlanRefusal>(&answer);
  return refusal != nullptr && !refusal->what.empty() && !refusal->remedy.empty();
}

TEST(BenchPlan, AllowsTheRunsOwnVoltageAndNotMore) {
  const Plan plan = planned(request_for(2400));
  EXPECT_EQ(plan.limits.v_max, Volts(2400));
  ASSERT_EQ(plan.steps.size(), 1U);
  EXPECT_EQ(plan.steps[0].v_max, Volts(2400));
  EXPECT_FALSE(plan.steps[0].image_confirms);
  EXPECT_EQ(plan.limits.depth_max, from_um(limits::kStroke_um));
  EXPECT_LT(plan.steps[0].depth, plan.limits.depth_max);
}

TEST(BenchPlan, IsSealedWithItsHalfPeriodAndUnlikeAnyPlanForAPatient) {
  const Plan plan = planned(request_for(2400));
  EXPECT_TRUE(seal_holds(plan));
  Plan slower = plan, patient = plan;
  slower.bench->half_period = Seconds(0.5);
  patient.bench.reset();
  EXPECT_FALSE(seal_holds(slower));
  EXPECT_FALSE(seal_holds(patient));
}

TEST(BenchPlan, ExpectsMoreTravelOfASlowWave) {
  const Millimetres fast = expected_travel(request_for(2000, 50, 0.05)),
                    slow = expected_travel(request_for(2000, 50, 2.5));
  EXPECT_GT(slow, fast);
  // Much faster than the leakage: K times the voltage is all the films ever see.
  EXPECT_NEAR(expected_travel(request_for(2000, 50, 1e-4)).value,
              NominalModel(Grams(50)).depth_on_films(Volts(0.8 * 2000)).value, 1e-3);
}

// m x'' = -k x from rest: the speed through the middle is the amplitude times sqrt(k / m).
TEST(BenchPlan, KnowsHowFastAnUndampedPlateSwings) {
  EXPECT_NEAR(NominalModel(Grams(50)).speed_after_push(), std::sqrt(140.0 / 0.080), 1e-9);
  for (const double grams : {0.0, 50.0, 300.0}) {
    const NominalModel model{Grams(grams)};
    EXPECT_LT(model.speed_after_voltage(), model.speed_after_push()) << "oil flows first";
    EXPECT_GT(model.speed_after_voltage(), 0.0);
  }
}

TEST(BenchPlan, IsRefusedWhereTheStageWouldReachItsEnd) {
  EXPECT_FALSE(refused(request_for(3500)));
  EXPECT_TRUE(refused(request_for(4500)));
  EXPECT_FALSE(refused(request_for(4500, 200)));
}

TEST(BenchPlan, IsRefusedOutsideOfWhatTheRobotCanDo) {
  EXPECT_TRUE(refused(request_for(8001, 300)));
  EXPECT_TRUE(refused(request_for(50)));
  EXPECT_TRUE(refused(request_for(-2000)));
  EXPECT_TRUE(refused(request_for(2000, -1)));
  EXPECT_TRUE(refused(request_for(2000, 301)));
}

}  // namespace
}  // namespace biopsy::planner
