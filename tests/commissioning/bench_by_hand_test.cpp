// Weights that a hand lays on: late, slowly, and yet in the data when they really pushed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "planner/bench_plan.hpp"
#include "robot/app/bench_run.hpp"
#include "robot/app/experiments.hpp"
#include "robot/app/hand_push.hpp"
#include "sim/devices/sim_stage.hpp"
#include "sim/simulate.hpp"

namespace biopsy::app {
namespace {

constexpr std::size_t kPeriod_ticks = 500;  // 2 Hz
constexpr double kLaidOver_s = 0.05;        // a thread that goes slack

sim::PlantModel stage_with(double friction_N, double weight_g) {
  sim::PlantModel model;
  model.effects.sensor_noise = sim::SensorNoise{.std = 10e-6};
  if (friction_N > 0.0) model.effects.coulomb_friction = sim::CoulombFriction{.force = friction_N};
  model.weight = weight_g * 1e-3;
  return model;
}

// Does what it was asked for, a second or so later.
class Hand {
 public:
  Hand(sim::SimStage& stage, unsigned seed) : stage_(stage), random_(seed) {}

  void asked(double push_N) {
    if (push_N == asked_N_) return;
    from_N_ = asked_N_, asked_N_ = push_N;
    begins_s_ = now_s_ + std::uniform_real_distribution<double>(0.3, 1.8)(random_);
    began_s.push_back(begins_s_);
  }
  void tick() {
    now_s_ += 1e-3;
    const double share = std::clamp((now_s_ - begins_s_) / kLaidOver_s, 0.0, 1.0);
    stage_.push(from_N_ + share * (asked_N_ - from_N_));
  }

  std::vector<double> began_s;  // since the first tick

 private:
  sim::SimStage& stage_;
  std::mt19937 random_;
  double now_s_ = 0.0, begins_s_ = 0.0, from_N_ = 0.0, asked_N_ = 0.0;
};

struct ByHand {
  BenchResult result;
  std::vector<double> began_s;
};

ByHand played_by_hand(const std::string& experiment, const sim::PlantModel& model, unsigned seed) {
  const BenchRun run = runs_of({experiment}, {.weight = Grams(model.weight * 1e3), .by_hand = true}).front();
  const auto plan = planner::plan_bench(bench_request(run));
  sim::SimStage stage(model, seed);
  Hand hand(stage, seed);
  bool turned = false;
  ByHand played;
  played.result = run_on_bench(run, std::get<Plan>(plan), 1,
                               {.stage = stage,
                                .push = [&](double push_N) { hand.asked(push_N); },
                                .played = [](double) {},
                                .keys =
                                    [&] {
                                      hand.tick();
                                      turned = turned || stage.now_us() > 1'000'000;
                                      return BenchKeys{.arm = turned, .estop_closed = true};
                                    }});
  played.began_s = hand.began_s;
  return played;
}

double rms_mm(const sim::RecordedRun& run, const sim::PlantModel& model) {
  const sim::RecordedRun again = sim::simulate(model, run);
  double sum = 0.0;
  for (std::size_t i = 0; i < run.displacement.size(); ++i)
    sum += std::pow(run.displacement[i] - again.displacement[i], 2);
  return 1e3 * std::sqrt(sum / static_cast<double>(run.displacement.size()));
}

TEST(BenchByHand, EachPushBeginsWhereTheHandBegan) {
  for (const char* experiment : {"load", "impact"})
    for (const double weight_g : {20.0, 50.0, 200.0})
      for (const unsigned seed : {1U, 2U, 3U}) {
        ByHand played = played_by_hand(experiment, stage_with(0.0, weight_g), seed);
        ASSERT_EQ(played.result.stopped_because, "") << experiment;
        const std::vector<HandPush> pushes = date_by_depth(played.result.recorded, kPeriod_ticks);
        ASSERT_EQ(pushes.size(), played.began_s.size());
        for (std::size_t i = 0; i < pushes.size(); ++i) {
          EXPECT_TRUE(pushes[i].seen) << experiment << " " << weight_g << " g, " << i;
          EXPECT_NEAR(pushes[i].began_s, played.began_s[i] + kLaidOver_s / 2, 0.035)
              << experiment << " " << weight_g << " g, " << i;
        }
      }
}

// What the dates are for: the same forces played through the stage's own model give the same depth.
TEST(BenchByHand, TheModelOfTheStageFollowsTheDatedPushesAndNotTheAsked) {
  sim::PlantModel model = stage_with(0.0, 50.0);
  sim::RecordedRun run = played_by_hand("load", model, 4).result.recorded;
  model.effects.sensor_noise.reset();
  const double as_asked = rms_mm(run, model);
  date_by_depth(run, kPeriod_ticks);
  EXPECT_LT(rms_mm(run, model), 0.05);
  EXPECT_GT(as_asked, 5.0 * rms_mm(run, model));
}

TEST(BenchByHand, WhatTheDepthDoesNotShowStaysAsAskedAndIsSaid) {
  sim::RecordedRun run = played_by_hand("impact", stage_with(0.0, 50.0), 5).result.recorded;
  const std::vector<double> asked = run.external_force;
  std::ranges::fill(run.displacement, 0.0);
  for (const HandPush& push : date_by_depth(run, kPeriod_ticks)) {
    EXPECT_FALSE(push.seen);
    EXPECT_EQ(push.began_s, push.asked_s);
  }
  EXPECT_EQ(run.external_force, asked);
}

// No push in the scatter and the oscillation alone, at any seed.
TEST(BenchByHand, NoiseAndOscillationAreNoPush) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U}) {
    const BenchRun run = runs_of({"load"}, {.weight = Grams(50.0), .by_hand = true}).front();
    const auto plan = planner::plan_bench(bench_request(run));
    sim::SimStage stage(stage_with(0.02, 50.0), seed);
    BenchResult result = run_on_bench(run, std::get<Plan>(plan), 1,
                                      {.stage = stage, .push = [](double) {}, .played = [](double) {}});
    for (const HandPush& push : date_by_depth(result.recorded, kPeriod_ticks))
      EXPECT_FALSE(push.seen) << seed << ": " << push.asked_s << " s";
  }
}

TEST(BenchByHand, WeightsAreWholeGramsAndLastUntilAHandCanFollow) {
  for (const double weight_g : {0.0, 50.0, 300.0})
    for (const BenchRun& run : runs_of({"load", "impact"}, {.weight = Grams(weight_g), .by_hand = true}))
      for (const LoadStep& load : run.loads) {
        const double grams = grams_of(load.push_N);
        EXPECT_NEAR(grams, std::round(grams), 1e-9) << run.name;
        EXPECT_GE(grams, 1.0);
        EXPECT_GE(load.to_tick - load.from_tick, 4'000U);
      }
}

}  // namespace
}  // namespace biopsy::app
