// Effects of one run on the next, and runs that are interrupted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "planner/plan/bench_plan.hpp"
#include "robot/bench/bench_run.hpp"
#include "robot/bench/experiments.hpp"
#include "sim/simulated_stage.hpp"

namespace biopsy::robot {
namespace {

constexpr double kTau_s = 6.9;  // of the films, model.md

sim::PlantModel bench_model() {
  sim::PlantModel model;
  model.effects.sensor_noise = sim::SensorNoise{.std = 10e-6};
  model.weight = 0.050;
  return model;
}

BenchResult played(const BenchRun& run, sim::SimulatedStage& stage, Seconds rest,
                   const std::function<bool()>& stop = {}) {
  const auto plan = planner::plan_bench(bench_request(run));
  return run_on_bench(
      run, std::get<Plan>(plan), 1,
      {.stage = stage, .push = [](double) {}, .show_progress = [](double) {}, .rest = rest, .stop = stop});
}

double travel_mm(const BenchResult& result) {
  const std::vector<double>& depth = result.recorded.displacement;
  return 1e3 * (*std::ranges::max_element(depth) - depth.front());
}

BenchRun run_named(const std::string& name) {
  for (BenchRun& run : runs_of({"dc", "staircase"}, {.weight = Grams(50.0)}))
    if (run.name == name) return run;
  throw std::logic_error(name);
}

// After one polarity the films keep a charge, which helps the other polarity's jump.
TEST(BenchBetweenRuns, ARestRemovesTheEffectOfTheRunBefore) {
  const BenchRun plus = run_named("dc-plus-50g"), minus = run_named("dc-minus-50g");
  const auto after = [&](Seconds rest, bool used) {
    sim::SimulatedStage stage(bench_model(), 3);
    if (used) {
      EXPECT_EQ(played(plus, stage, Seconds(0)).stopped_because, "");
    }
    return played(minus, stage, rest);
  };
  const double fresh = travel_mm(after(Seconds(0), false));
  EXPECT_NEAR(travel_mm(after(Seconds(7.0 * kTau_s), true)), fresh, 0.05);
  const BenchResult at_once = after(Seconds(0), true);
  EXPECT_TRUE(!at_once.stopped_because.empty() || std::abs(travel_mm(at_once) - fresh) > 0.5)
      << "were it not for the rest: " << travel_mm(at_once) << " for " << fresh << " mm";
}

TEST(BenchBetweenRuns, TheRestIsNotPartOfTheRecord) {
  sim::SimulatedStage stage(bench_model(), 3), other(bench_model(), 3);
  const BenchRun run = run_named("staircase-50g");
  const auto rows = played(run, stage, Seconds(20)).recorded.time.size();
  EXPECT_NEAR(static_cast<double>(rows),
              static_cast<double>(played(run, other, Seconds(0)).recorded.time.size()), 1000.0);
}

TEST(BenchBetweenRuns, StoppedInItsRestItNeverBegins) {
  const BenchRun run = run_named("staircase-50g");
  const auto plan = planner::plan_bench(bench_request(run));
  sim::SimulatedStage stage(bench_model(), 3);
  int ticks = 0;
  bool asked = false;
  const BenchResult result = run_on_bench(run, std::get<Plan>(plan), 1,
                                          {.stage = stage,
                                           .push = [](double) {},
                                           .show_progress = [](double) {},
                                           .rest = Seconds(20),
                                           .request_key = [&] { asked = true; },
                                           .stop = [&] { return ++ticks > 5'000; }});
  EXPECT_EQ(result.stopped_because, "interrupted");
  EXPECT_TRUE(result.recorded.time.empty());
  EXPECT_FALSE(asked);
}

TEST(BenchBetweenRuns, InterruptedRunEndsAtZeroVoltsAndKeepsItsRows) {
  const BenchRun run = run_named("staircase-50g");
  for (const int after_ticks : {200, 1'000, 3'000, 12'000}) {
    sim::SimulatedStage stage(bench_model(), 3);
    int ticks = 0;
    const BenchResult result = played(run, stage, Seconds(0), [&] { return ++ticks > after_ticks; });
    EXPECT_EQ(result.stopped_because, "interrupted");
    ASSERT_FALSE(result.recorded.input.empty());
    EXPECT_EQ(result.recorded.input.back(), 0.0) << after_ticks;
    EXPECT_LT(result.recorded.displacement.back(), 1e-3) << after_ticks;
    EXPECT_NEAR(result.stopped_s, 1e-3 * after_ticks, 2e-3);
  }
}

}  // namespace
}  // namespace biopsy::robot
