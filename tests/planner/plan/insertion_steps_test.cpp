#include "planner/plan/insertion_steps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "safety/types/limits.hpp"

namespace biopsy::planner {
namespace {

Layer layer(const std::string& name, double from, double to) {
  return {name, Millimetres(from), Millimetres(to)};
}

const std::vector<Layer> kPhantom = {layer("muscle", 0, 2), layer("gap", 2, 2.9), layer("liver", 2.9, 20)};

std::vector<Millimetres> millimetres(const std::vector<double>& values) {
  std::vector<Millimetres> depths;
  for (const double value : values) depths.emplace_back(value);
  return depths;
}

std::vector<InsertionStep> steps_in(const std::vector<Layer>& layers, double target,
                                    const std::vector<double>& waypoints = {},
                                    Staging staging = Staging::Automatic) {
  return plan_steps(layers, Millimetres(target), millimetres(waypoints), staging, Pace{},
                    NominalModel(Grams(50)));
}

void expect_depths(const std::vector<InsertionStep>& steps, const std::vector<double>& depths) {
  ASSERT_EQ(steps.size(), depths.size());
  for (std::size_t n = 0; n < depths.size(); ++n) EXPECT_NEAR(steps[n].depth.value, depths[n], 1e-9) << n;
}

TEST(Stages, GapSamplingGoesDirectlyAsThePaperDid) {
  const auto steps = steps_in(kPhantom, 2.5, {}, Staging::AsGiven);
  expect_depths(steps, {2.5});
  EXPECT_EQ(steps[0].kind, StepKind::Target);
  EXPECT_EQ(steps[0].speed, Pace{}.crossing);  // through muscle | gap
  EXPECT_TRUE(steps[0].image_confirms);
  EXPECT_EQ(steps[0].why, "target in gap; slowly through muscle | gap at 2.00 mm");
}

TEST(Stages, LiverSamplingStopsAtTwoMillimetresForAnImage) {
  const auto steps = steps_in(kPhantom, 3.5, {2.0}, Staging::AsGiven);
  expect_depths(steps, {2.0, 3.5});
  EXPECT_EQ(steps[0].kind, StepKind::Waypoint);
  EXPECT_TRUE(steps[0].image_confirms && steps[1].image_confirms);
  EXPECT_NE(steps[1].why.find("gap | liver at 2.90 mm"), std::string::npos) << steps[1].why;
}

TEST(Stages, AutomaticStepsStopOnBothSidesOfEachBoundary) {
  const auto steps = steps_in(kPhantom, 3.5);
  expect_depths(steps, {1.7, 2.3, 2.6, 3.2, 3.5});
  const std::vector<StepKind> kinds = {StepKind::Approach, StepKind::Cross, StepKind::Approach,
                                       StepKind::Cross, StepKind::Target};
  const std::vector<bool> confirms = {false, false, true, false, true};
  for (std::size_t n = 0; n < steps.size(); ++n) {
    EXPECT_EQ(steps[n].kind, kinds[n]) << n;
    EXPECT_EQ(steps[n].image_confirms, confirms[n]) << n;
    EXPECT_EQ(steps[n].speed, kinds[n] == StepKind::Cross ? Pace{}.crossing : Pace{}.speed) << n;
  }
  EXPECT_EQ(steps[0].why, "stop short of muscle | gap at 2.00 mm");
  EXPECT_EQ(steps[1].why, "stop behind muscle | gap at 2.00 mm");
}

TEST(Stages, ALayerTooThinForAStopIsCrossedInOneStep) {
  const auto steps = steps_in({layer("muscle", 0, 2), layer("capsule", 2, 2.5), layer("liver", 2.5, 9)}, 4.0);
  expect_depths(steps, {1.7, 2.8, 4.0});
  EXPECT_EQ(steps[1].why, "stop behind muscle | capsule at 2.00 mm and capsule | liver at 2.50 mm");
  EXPECT_TRUE(steps[0].image_confirms);
}

TEST(Stages, ATargetCloseBehindABoundaryEndsTheCrossing) {
  expect_depths(steps_in(kPhantom, 2.1), {1.7, 2.1});
  expect_depths(steps_in(kPhantom, 2.4), {1.7, 2.4});  // 2.3 and 2.4 are one stop
}

TEST(Stages, ATargetCloseBeforeABoundaryIsApproachedSlowly) {
  const auto steps = steps_in(kPhantom, 2.8);
  expect_depths(steps, {1.7, 2.3, 2.6, 2.8});
  EXPECT_EQ(steps.back().speed, Pace{}.crossing);
  EXPECT_EQ(steps.back().why, "target in gap, slowly: a boundary is near");
}

TEST(Stages, ATargetOnABoundaryIsApproachedAsACrossing) {
  const auto steps = steps_in(kPhantom, 2.0);
  expect_depths(steps, {1.7, 2.0});
  EXPECT_EQ(steps.back().speed, Pace{}.crossing);
  EXPECT_TRUE(steps[0].image_confirms);
}

TEST(Stages, ABoundaryAtTheEntryNeedsNoStopBeforeIt) {
  expect_depths(steps_in({layer("skin", 0, 0.4), layer("muscle", 0.4, 9)}, 4.0), {0.7, 4.0});
}

TEST(Stages, OneLayerIsOneStep) {
  const auto steps = steps_in({layer("muscle", 0, 20)}, 5.0);
  expect_depths(steps, {5.0});
  EXPECT_EQ(steps[0].speed, Pace{}.speed);
  EXPECT_EQ(steps[0].why, "target in muscle");
}

TEST(Stages, AWaypointReplacesAStopBesideItButNotOneAcrossABoundary) {
  expect_depths(steps_in(kPhantom, 3.5, {1.6}), {1.6, 2.3, 2.6, 3.2, 3.5});
  expect_depths(steps_in(kPhantom, 3.5, {1.8}), {1.7, 1.8, 2.3, 2.6, 3.2, 3.5});
  expect_depths(steps_in(kPhantom, 3.5, {1.0, 2.0}), {1.0, 1.7, 2.0, 2.3, 2.6, 3.2, 3.5});
}

// A random stack of layers, target and waypoints.
struct RandomPath {
  std::vector<Layer> layers;
  double target = 0.0;
  std::vector<double> waypoints;
};

RandomPath random_path(std::mt19937_64& random) {
  const auto between = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  RandomPath path{.layers = {}, .target = between(0.5, 11.0), .waypoints = {}};
  for (double from = 0.0; from <= path.target;) {
    const double to = from + (random() % 3 == 0 ? between(0.05, 0.8) : between(0.3, 5.0));
    path.layers.push_back(layer("L" + std::to_string(path.layers.size()), from, to));
    from = to;
  }
  for (double depth = between(0.2, 4.0); depth <= path.target - 0.2 && random() % 2 == 0;
       depth += between(0.2, 4.0))
    path.waypoints.push_back(depth);
  return path;
}

void expect_each_boundary_is_respected(const RandomPath& path, const std::vector<InsertionStep>& steps,
                                       Staging staging) {
  for (std::size_t n = 1; n < path.layers.size(); ++n) {
    const double boundary = path.layers[n].from.value;
    double start = 0.0;
    for (const InsertionStep& step : steps) {
      const bool comes_near = start < boundary + 0.3 - 1e-5 && step.depth.value > boundary - 0.3 + 1e-5;
      if (comes_near) {
        EXPECT_EQ(step.speed, Pace{}.crossing) << "boundary " << boundary;
      }
      start = step.depth.value;
    }
    if (boundary >= path.target || staging == Staging::AsGiven) continue;
    // Some stop is short of it, unless it is at the entry or too close to the boundary before it.
    const bool at_entry = boundary < 0.3 + 0.2;
    const bool too_close = n > 1 && boundary - path.layers[n - 1].from.value < 0.3 + 0.3 + 0.2;
    if (at_entry || too_close) continue;
    EXPECT_TRUE(std::any_of(steps.begin(), steps.end(),
                            [&](const InsertionStep& step) {
                              return step.depth.value <= boundary - 0.3 + 1e-5 &&
                                     step.depth.value >= boundary - 0.5 - 1e-5;
                            }))
        << "boundary " << boundary;
  }
}

TEST(Stages, HoldTheirInvariantsOverRandomTissue) {
  std::mt19937_64 random(17);
  for (int trial = 0; trial < 5000; ++trial) {
    const RandomPath path = random_path(random);
    const Staging staging = trial % 3 == 0 ? Staging::AsGiven : Staging::Automatic;
    const auto steps = steps_in(path.layers, path.target, path.waypoints, staging);
    SCOPED_TRACE(testing::Message() << "trial " << trial << ", target " << path.target);

    ASSERT_FALSE(steps.empty());
    EXPECT_EQ(steps.back().depth.value, path.target);
    EXPECT_EQ(steps.back().kind, StepKind::Target);
    EXPECT_TRUE(steps.back().image_confirms);
    double previous = 0.0;
    for (const InsertionStep& step : steps) {
      EXPECT_GT(step.depth.value, previous);
      EXPECT_GT(step.v_max.value, 0.0);
      EXPECT_LE(to_mV(step.v_max), limits::kDriveMax_mV);
      EXPECT_FALSE(step.why.empty());
      EXPECT_EQ(step.dwell, Pace{}.dwell);
      previous = step.depth.value;
    }
    for (const double waypoint : path.waypoints)
      EXPECT_EQ(std::count_if(steps.begin(), steps.end(),
                              [&](const InsertionStep& s) { return s.depth.value == waypoint; }),
                1);
    if (staging == Staging::AsGiven) {
      EXPECT_EQ(steps.size(), path.waypoints.size() + 1);
    }
    expect_each_boundary_is_respected(path, steps, staging);

    // An image confirms the last stop in front of the target's layer, wherever there is one.
    const auto before = [&](const InsertionStep& step) {
      return step.depth.value <= path.layers.back().from.value + 1e-6;
    };
    const auto last = std::find_if(steps.rbegin() + 1, steps.rend(), before);
    if (last != steps.rend()) {
      EXPECT_TRUE(last->image_confirms);
    }
    if (testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace biopsy::planner
