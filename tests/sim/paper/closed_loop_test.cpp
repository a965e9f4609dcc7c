// The paper's loop on the plant: statics, inertia and bounds that hold on any stage.
#include "sim/paper/closed_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/paper/figures/loop_scores.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim::paper {
namespace {

const LoopSettings kNoLoop{.gains = {0.0, 0.0}, .highest = 8000.0, .feed = {}};

PlantModel rehearsal() {
  PlantModel model = read_model(source_dir() / "sim/models/rehearsal.toml");
  model.baseline.tau_h = 0.3;  // slow oil and a damped slider: the loop holds it
  model.baseline.c_s = 1.7;
  return model;
}

Course weighed(double mass, double seconds) {
  return follow(PlantModel{},
                {.target = [](double) { return 0.0; }, .seconds = seconds, .loads = {{1.0, 11.0, mass}}},
                kNoLoop);
}

TEST(PaperLoop, AWeightSagsTheSpringByMgOverK) {
  const PlantModel model;
  const Course course = weighed(0.020, 20.0);
  const double sag = 0.020 * model.baseline.g / model.baseline.k * 1e3;
  EXPECT_NEAR(mean_between(course, course.plate_a, 10.0, 11.0), -sag, 1e-6 * sag);
  EXPECT_NEAR(mean_between(course, course.plate_a, 19.0, 20.0), 0.0, 1e-6 * sag);  // and comes back
}

// Half a period of the spring with all that hangs on it, added weight included.
TEST(PaperLoop, AWeightAddsItsInertia) {
  PlantModel model;
  const double added = 0.020;
  const Course course = weighed(added, 2.0);
  const auto lowest = std::min_element(course.plate_a.begin(), course.plate_a.end());
  const double mass = model.mass_A() + added, damping = model.baseline.c_s + model.baseline.c_k;
  const double omega = std::sqrt(model.baseline.k / mass - std::pow(damping / (2.0 * mass), 2));
  const double when = course.time[static_cast<std::size_t>(lowest - course.plate_a.begin())] - 1.0;
  EXPECT_NEAR(when, std::numbers::pi / omega, 2e-3);
  EXPECT_GT(when, 1.05 * std::numbers::pi / std::sqrt(model.baseline.k / model.mass_A()));
}

// Undamped: the weight keeps its momentum, and swings about the sagged rest.
TEST(PaperLoop, AFallingWeightSwingsAsItsMomentumHasIt) {
  PlantModel model;
  model.baseline.c_s = model.baseline.c_k = 0.0;
  const double added = 0.020, speed = 0.2;
  const Course course = follow(model,
                               {.target = [](double) { return 0.0; },
                                .seconds = 2.0,
                                .loads = {{.from = 1.0, .to = 11.0, .mass = added, .speed = speed}}},
                               kNoLoop);
  const double mass = model.mass_A() + added, sag = added * model.baseline.g / model.baseline.k;
  const double thrown = added * speed / mass * std::sqrt(mass / model.baseline.k);
  const double lowest = *std::min_element(course.plate_a.begin(), course.plate_a.end());
  EXPECT_NEAR(lowest, -1e3 * (sag + std::hypot(sag, thrown)), 0.01);
}

TEST(PaperLoop, IteratesOncePerPeriod) {
  const Course course = follow(
      rehearsal(), {.target = square_target(2.0, 8.0, 0.5), .seconds = 3.0, .loads = {}}, paper_loop(3e-3));
  std::size_t changed = 0;
  for (std::size_t k = 1; k < course.amplitude.size(); ++k) {
    if (course.amplitude[k] == course.amplitude[k - 1]) continue;
    EXPECT_EQ(k % 3, 0U);
    ++changed;
  }
  EXPECT_GT(changed, 300U);
}

TEST(PaperLoop, AmplitudeIsWithinItsLimits) {
  const Course course =
      follow(rehearsal(), {.target = square_target(2.0, 8.0, 0.5), .seconds = 6.0, .loads = {}},
             {.gains = {}, .highest = 4000.0, .feed = {}});
  const auto [low, high] = std::minmax_element(course.amplitude.begin(), course.amplitude.end());
  EXPECT_EQ(*low, 0.0);
  EXPECT_EQ(*high, 4.0);
}

TEST(PaperLoop, OfThePaperSaturatesAtItsAmplifier) {
  const Course course =
      follow(rehearsal(), {.target = [](double) { return 50.0; }, .seconds = 1.0, .loads = {}}, paper_loop());
  EXPECT_EQ(*std::max_element(course.amplitude.begin(), course.amplitude.end()), 10.0);
}

TEST(PaperLoop, HoldsADampedStageWithinThePapersError) {
  const Course course =
      follow(rehearsal(), {.target = [](double) { return 4.0; }, .seconds = 10.0, .loads = {}});
  EXPECT_LT(rmse_settled(course), 0.077);
}

TEST(PaperLoop, IsDeterministic) {
  const LoopTask task{.target = sine_target(0.0, 4.0, 0.5), .seconds = 4.0, .loads = {}};
  EXPECT_EQ(follow(rehearsal(), task).plate_a, follow(rehearsal(), task).plate_a);
}

TEST(PaperLoop, AConstantFeedForwardInitialisesTheIntegral) {
  const LoopTask task{.target = [](double) { return 3.0; }, .seconds = 6.0, .loads = {}};
  LoopSettings none, constant;
  none.feed = [](double) { return 0.0; };
  constant.feed = [](double) { return 1500.0; };
  const Course plain = follow(rehearsal(), task), zero = follow(rehearsal(), task, none),
               fed = follow(rehearsal(), task, constant);
  EXPECT_EQ(plain.plate_a, zero.plate_a);
  EXPECT_NEAR(fed.amplitude.front() - plain.amplitude.front(), 1.5, 1e-9);
  EXPECT_NEAR(rmse_settled(fed), rmse_settled(plain), 0.05);  // the loop still decides where it ends
}

TEST(PaperLoop, TargetsHaveTheirLevels) {
  const OfTime square = square_target(2.0, 8.0, 0.05), sine = sine_target(0.0, 8.0, 0.05);
  EXPECT_EQ(square(9.999), 2.0);
  EXPECT_EQ(square(10.0), 8.0);
  EXPECT_EQ(square(20.0), 2.0);
  EXPECT_NEAR(sine(0.0), 0.0, 1e-12);
  EXPECT_NEAR(sine(5.0), 4.0, 1e-12);
  EXPECT_NEAR(sine(10.0), 8.0, 1e-12);
  const OfTime stair = stair_target({1.0, 2.0}, {3.0, 0.5});
  EXPECT_EQ(stair(0.999), 0.0);
  EXPECT_EQ(stair(1.0), 3.0);
  EXPECT_EQ(stair(5.0), 0.5);
}

}  // namespace
}  // namespace biopsy::sim::paper
