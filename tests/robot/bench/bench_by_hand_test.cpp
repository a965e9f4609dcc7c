// Weights laid on by hand, late and slowly, are dated in the data when they began to push.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "planner/plan/bench_plan.hpp"
#include "robot/bench/bench_run.hpp"
#include "robot/bench/experiments.hpp"
#include "robot/bench/hand_push.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/simulate.hpp"
#include "sim/simulated_stage.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::robot {
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

// Lays on the requested weight a second or so later.
class Hand {
 public:
  Hand(sim::SimulatedStage& stage, unsigned seed, double latest_s)
      : stage_(stage), random_(seed), latest_s_(latest_s) {}

  void asked(double push_N) {
    if (push_N == asked_N_) return;
    from_N_ = asked_N_, asked_N_ = push_N;
    begins_s_ = now_s_ + std::uniform_real_distribution<double>(0.1, latest_s_)(random_);
    began_s.push_back(begins_s_);
  }
  void tick() {
    now_s_ += 1e-3;
    const double share = std::clamp((now_s_ - begins_s_) / kLaidOver_s, 0.0, 1.0);
    stage_.push(from_N_ + share * (asked_N_ - from_N_));
  }

  double now_s() const { return now_s_; }

  std::vector<double> began_s;  // since the first tick

 private:
  sim::SimulatedStage& stage_;
  std::mt19937 random_;
  double latest_s_;
  double now_s_ = 0.0, begins_s_ = 0.0, from_N_ = 0.0, asked_N_ = 0.0;
};

struct ByHand {
  BenchResult result;
  std::vector<double> began_s;
  double first_row_s = 0.0;  // by the same clock
};

ByHand played_by_hand(const std::string& experiment, const sim::PlantModel& model, unsigned seed,
                      double latest_s = 3.0, const BenchSetup& more = {}, double until_s = 1e9) {
  BenchSetup setup = more;
  setup.weight = Grams(model.weight * 1e3);
  setup.by_hand = true;
  const BenchRun run = runs_of({experiment}, setup).front();
  const auto plan = planner::plan_bench(bench_request(run));
  sim::SimulatedStage stage(model, seed);
  Hand hand(stage, seed, latest_s);
  std::int64_t asked_us = std::numeric_limits<std::int64_t>::max();
  ByHand played;
  played.result = run_on_bench(run, std::get<Plan>(plan), 1,
                               {.stage = stage,
                                .push = [&](double push_N) { hand.asked(push_N); },
                                .show_progress = [](double) {},
                                .keys =
                                    [&] {
                                      hand.tick();
                                      const bool turned = stage.now_us() - 500'000 > asked_us;
                                      return BenchKeys{.arm = turned, .estop_closed = true};
                                    },
                                .request_key = [&] { asked_us = stage.now_us(); },
                                .stop = [&] { return static_cast<double>(stage.now_us()) > until_s * 1e6; }});
  played.began_s = hand.began_s;
  played.first_row_s = hand.now_s() - static_cast<double>(played.result.recorded.time.size()) * 1e-3;
  return played;
}

std::vector<HandPush> dated(sim::RecordedRun& run) {
  return date_by_depth(run, kPeriod_ticks, run.time.size());
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
    for (const double weight_g : {0.0, 50.0, 200.0})
      for (const double latest_s : {0.2, 1.5, 3.0})
        for (const unsigned seed : {1U, 2U, 3U}) {
          ByHand played = played_by_hand(experiment, stage_with(0.0, weight_g), seed, latest_s);
          ASSERT_EQ(played.result.stopped_because, "") << experiment;
          const std::vector<HandPush> pushes = dated(played.result.recorded);
          ASSERT_EQ(pushes.size(), played.began_s.size());
          for (std::size_t i = 0; i < pushes.size(); ++i) {
            EXPECT_TRUE(pushes[i].seen) << experiment << " " << weight_g << " g, " << i;
            EXPECT_NEAR(pushes[i].began_s + played.first_row_s, played.began_s[i] + kLaidOver_s / 2, 0.05)
                << experiment << " " << weight_g << " g, " << latest_s << " s, " << i;
          }
        }
}

// How many of the four changes of three load runs are seen; none of them elsewhere than the hand was.
std::size_t seen_in_three_loads(const sim::PlantModel& model, const BenchSetup& setup,
                                double within_s = 0.06) {
  std::size_t seen = 0;
  for (const unsigned seed : {1U, 2U, 3U}) {
    ByHand played = played_by_hand("load", model, seed, 3.0, setup);
    const std::vector<HandPush> pushes = dated(played.result.recorded);
    EXPECT_EQ(pushes.size(), 4U) << played.result.stopped_because;
    for (std::size_t i = 0; i < pushes.size(); ++i) {
      if (!pushes[i].seen) continue;
      ++seen;
      EXPECT_NEAR(pushes[i].began_s + played.first_row_s, played.began_s[i] + kLaidOver_s / 2, within_s) << i;
    }
  }
  return seen;
}

// Friction holds the smaller pushes, and is no reason to date the others wrongly.
TEST(BenchByHand, WithFrictionTheSeenPushesAreDatedRightly) {
  EXPECT_GE(seen_in_three_loads(stage_with(0.05, 50.0), {.weight = Grams(50.0), .push_scale = 2.0}), 6U);
}

// The stage behind the paper's figures: guide, retained charge, a reading that is late, and damping that lets
// plate A follow its spring with 26 ms. Forty hands, not three: of 160
// changes of load up to one in eight is dated wrongly there, by up to 2.1 s.
TEST(BenchByHand, OnTheCalibratedStageMostAreSeenAndOneInEightIsDatedWrongly) {
  sim::PlantModel model = sim::read_model(source_dir() / "sim/models/calibrated.toml");
  model.weight = 0.050;
  const BenchSetup setup{.weight = Grams(50.0), .drive_scale = 2.0, .push_scale = 2.5};
  int seen = 0, wrong = 0, changes = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    ByHand played = played_by_hand("load", model, seed, 3.0, setup);
    const std::vector<HandPush> pushes = dated(played.result.recorded);
    ASSERT_EQ(pushes.size(), 4U) << played.result.stopped_because;
    for (std::size_t i = 0; i < pushes.size(); ++i) {
      ++changes;
      if (!pushes[i].seen) continue;
      ++seen;
      const double off_s = pushes[i].began_s + played.first_row_s - played.began_s[i] - kLaidOver_s / 2;
      wrong += std::abs(off_s) > 0.1;
    }
  }
  EXPECT_GE(seen, changes * 3 / 4) << "seen " << seen << ", wrong " << wrong << " of " << changes;
  EXPECT_LE(wrong, changes / 8) << "seen " << seen << ", wrong " << wrong << " of " << changes;
}

// The withdrawal is not taken for a weight that was lifted off.
TEST(BenchByHand, StoppedUnderAWeightItIsRecordedAsLyingThere) {
  for (const double until_s : {14.0, 18.3, 26.0}) {
    ByHand played = played_by_hand("load", stage_with(0.0, 50.0), 1, 1.0, {}, until_s);
    EXPECT_EQ(played.result.stopped_because, "interrupted");
    sim::RecordedRun& run = played.result.recorded;
    const auto stopped = static_cast<std::size_t>(std::lround(played.result.stopped_s * 1e3));
    const double lay_N = run.external_force.back();
    EXPECT_GT(lay_N, 0.0) << until_s;
    date_by_depth(run, kPeriod_ticks, stopped);
    EXPECT_EQ(run.external_force.back(), lay_N);
  }
}

// The dated forces, simulated with the stage's own model, give the same depth.
TEST(BenchByHand, ModelFollowsTheDatedPushesNotTheRequested) {
  sim::PlantModel model = stage_with(0.0, 50.0);
  sim::RecordedRun run = played_by_hand("load", model, 4).result.recorded;
  model.effects.sensor_noise.reset();
  const double as_asked = rms_mm(run, model);
  dated(run);
  EXPECT_LT(rms_mm(run, model), 0.05);
  EXPECT_GT(as_asked, 5.0 * rms_mm(run, model));
}

TEST(BenchByHand, PushThatTheDepthDoesNotShowStaysAsRequested) {
  sim::RecordedRun run = played_by_hand("impact", stage_with(0.0, 50.0), 5).result.recorded;
  const std::vector<double> asked = run.external_force;
  std::ranges::fill(run.displacement, 0.0);
  const std::vector<HandPush> pushes = dated(run);
  EXPECT_EQ(pushes.size(), 6U);
  for (const HandPush& push : pushes) {
    EXPECT_FALSE(push.seen);
    EXPECT_EQ(push.began_s, push.requested_s);
  }
  EXPECT_EQ(run.external_force, asked);
}

// No push in the scatter and the oscillation alone, at any seed.
TEST(BenchByHand, NoiseAndOscillationAreNoPush) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U}) {
    const BenchRun run = runs_of({"load"}, {.weight = Grams(50.0), .by_hand = true}).front();
    const auto plan = planner::plan_bench(bench_request(run));
    sim::SimulatedStage stage(stage_with(0.02, 50.0), seed);
    BenchResult result =
        run_on_bench(run, std::get<Plan>(plan), 1,
                     {.stage = stage, .push = [](double) {}, .show_progress = [](double) {}});
    const std::vector<HandPush> pushes = dated(result.recorded);
    EXPECT_EQ(pushes.size(), 4U) << result.stopped_because;
    for (const HandPush& push : pushes) EXPECT_FALSE(push.seen) << seed << ": " << push.requested_s << " s";
  }
}

TEST(BenchByHand, WeightsAreWholeGramsAndLastUntilAHandCanFollow) {
  for (const double weight_g : {0.0, 50.0, 300.0})
    for (const BenchRun& run : runs_of({"load", "impact"}, {.weight = Grams(weight_g), .by_hand = true}))
      for (const LoadStep& load : run.loads) {
        const double grams = grams_of(load.push_N);
        EXPECT_NEAR(grams, std::round(grams), 1e-9) << run.name;
        EXPECT_GE(grams, 1.0);
        EXPECT_GE(load.to_tick - load.from_tick, 6'000U);
      }
}

}  // namespace
}  // namespace biopsy::robot
