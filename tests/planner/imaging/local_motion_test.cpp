// Claims about what follows the rigid registration: local motion and brightness. All images are from
// formulas.
#include "planner/imaging/registration/local_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "planner/imaging/depth_check/find_tip.hpp"
#include "planner/imaging/depth_check/needle_corridor.hpp"
#include "planner/imaging/depth_check/prediction.hpp"
#include "planner/imaging/registration/brightness.hpp"
#include "tests/planner/imaging/analytic_scene.hpp"

namespace biopsy::imaging {
namespace {

// Tissue at p in the image after was at p + pushed(p) in the one before: up to 2 mm beside the needle.
Eigen::Vector3d pushed(const Point& p) {
  const Point centre(4.0, 10.0, 6.0);
  return 2.0 * std::exp(-0.5 * (p - centre).squaredNorm() / (14.0 * 14.0)) *
         Direction(0.6, -0.7, 0.4).normalized();
}

// What is predicted, in place of the image; NaN where nothing is.
Volume on_grid(Volume after, const Prediction& prediction) {
  std::fill(after.voxels.begin(), after.voxels.end(), std::numeric_limits<float>::quiet_NaN());
  for_each_voxel(prediction.rows, after.grid,
                 [&](const GridVoxel& voxel) { after.voxels[voxel.n] = prediction.value[voxel.m]; });
  return after;
}

struct LocalMotion : testing::Test {
  Grid grid = scene::grid(0.9, 3.0);
  Volume before = scene::imaged(scene::grid(0.7, 2.5), [](const Point& p) { return scene::tissue(p); });
  NeedleFrame frame = needle_frame(grid, scene::kEntry, scene::kAxis);
  NeedleMask mask{frame, -30.0, 50.0, 8.0}, everywhere{frame, -200.0, 200.0, 200.0};

  DisplacementField found(const Volume& after) const {
    return register_local(before, std::span(&after, 1), RigidTransform::Identity(), mask,
                          {.from_mm = -20.0, .to_mm = 45.0});
  }
};

TEST_F(LocalMotion, FollowsTissueThatWasPushedAside) {
  const Volume after = scene::imaged(
      grid, [](const Point& p) { return 1.2 * scene::tissue(p + pushed(p)) + 15.0 * scene::grain(p); });
  const DisplacementField field = found(after);
  double left = 0.0, moved = 0.0;
  int count = 0;
  for (double t = 0.0; t <= 40.0; t += 4.0)
    for (double u : {-12.0, 0.0, 12.0})
      for (double v : {-12.0, 0.0, 12.0}) {
        const Point p = frame.point(t, u, v);
        left += (field.at(p) - pushed(p)).squaredNorm(), moved += pushed(p).squaredNorm(), ++count;
      }
  EXPECT_LT(std::sqrt(left / count), 0.45 * std::sqrt(moved / count))
      << "mm left " << std::sqrt(left / count) << " of " << std::sqrt(moved / count);
}

// The field moves the prediction, not the image that shows the void. What a void and noise move is nothing if
// the reading of the tip stays: within a tenth of what an accept allows, 0.5 mm of depth, 2 mm beside the
// axis and 2 degrees, wherever along the field the tip is.
TEST_F(LocalMotion, MovesNothingForAVoidOrNoise) {
  CorridorSettings path;
  path.from_mm = -30.0, path.to_mm = 50.0;
  SearchReach reach;
  reach.depth_max_mm = 50.0;
  for (const double depth : {12.0, 20.0, 28.0, 35.0}) {
    const Volume after = scene::imaged(grid, [&](const Point& p) {
      return scene::tissue(p) * scene::left_by_needle(p, scene::kEntry, scene::kAxis, depth, 2.5) +
             25.0 * scene::grain(p);
    });
    RegistrationResult still;  // no places compared: no local motion is looked for
    const TipFinding without = find_tip(needle_corridor(before, after, still, frame, path), reach);
    still.points = 1;
    const TipFinding with = find_tip(needle_corridor(before, after, still, frame, path), reach);
    EXPECT_NEAR(without.depth_mm, depth, 0.5);  // the void is what is read
    EXPECT_NEAR(with.depth_mm, without.depth_mm, 0.05) << depth;
    EXPECT_LT((with.beside_mm.value - without.beside_mm.value).norm(), 0.2) << depth;
    EXPECT_LT((with.slope.value - without.slope.value).norm(), std::tan(0.2 * std::numbers::pi / 180.0))
        << depth;
  }
}

TEST_F(LocalMotion, IsAbsentBeyondItsLattice) {
  EXPECT_EQ(found(scene::imaged(grid, scene::tissue)).at(frame.point(20.0, 90.0, 0.0)).norm(), 0.0);
}

// A saturation band darkens one side with an edge of some millimetres; another contrast compresses the rest.
TEST_F(LocalMotion, BrightnessFollowsASaturationBandAndAnotherContrast) {
  const auto seen = [&](const Point& p) {
    const double band = 0.35 + 0.65 / (1.0 + std::exp(-(p.y() + 22.0) / 3.0));
    return band * (80.0 + 0.7 * scene::tissue(p));
  };
  const Volume after = scene::imaged(grid, seen);
  const Volume prediction = on_grid(after, predicted(before, after, {}, mask, everywhere));
  double left = 0.0, total = 0.0;
  for (std::size_t n = 0; n < after.voxels.size(); ++n) {
    if (!std::isfinite(prediction.voxels[n])) continue;
    left += std::pow(static_cast<double>(prediction.voxels[n] - after.voxels[n]), 2);
    total += std::pow(static_cast<double>(after.voxels[n]), 2);
  }
  EXPECT_LT(std::sqrt(left / total), 0.06);
}

TEST_F(LocalMotion, BrightnessOfAVoidIsNotLearned) {
  const Volume after = scene::imaged(grid, [](const Point& p) {
    return scene::tissue(p) * scene::left_by_needle(p, scene::kEntry, scene::kAxis, 20.0, 2.5);
  });
  const Volume prediction = on_grid(after, predicted(before, after, {}, mask, everywhere));
  const Sampler sampler(prediction);
  for (double t : {2.0, 8.0, 14.0}) {
    const Point p = frame.point(t, 0.0, 0.0);
    EXPECT_NEAR(sampler.at(p) / scene::tissue(p), 1.0, 0.12) << t;
  }
}

}  // namespace
}  // namespace biopsy::imaging
