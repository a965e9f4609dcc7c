// Confirmation images of a few slices: a slab, three orthogonal planes. The scene is a formula, so that the
// truth is known without any simulator.
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <vector>

#include "planner/imaging/depth_check/depth_check.hpp"
#include "tests/planner/imaging/analytic_scene.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::imaging {
namespace {

const Eigen::Vector3d kShift(1.0, -1.5, 0.8);
constexpr double kTip_mm = 20.0;

// `slices` of 1 x 1 x 3 mm whose first axes are `right` and `down`, the middle one through the needle.
Grid slices_in(const Direction& right, const Direction& down, int slices) {
  Grid g;
  g.size = {80, 80, slices};
  const Direction normal = right.cross(down);
  g.X_SI.linear() << right, down, 3.0 * normal;
  const Point centre = scene::kEntry + 12.0 * scene::kAxis;
  g.X_SI.translation() = centre - g.X_SI.linear() * Eigen::Vector3d(39.5, 39.5, 0.5 * (slices - 1));
  return g;
}

Volume imaged_with_needle(const Grid& grid, double depth) {
  return scene::imaged(grid, [&](const Point& p) {
    double sum = 0.0;  // a voxel sees the mean over its thickness
    for (int n = 0; n < 6; ++n) {
      const Point q = p + grid.X_SI.linear().col(2) * ((n + 0.5) / 6.0 - 0.5);
      sum += scene::tissue(q - kShift) * scene::left_by_needle(q, scene::kEntry, scene::kAxis, depth, 1.8);
    }
    return std::abs(sum / 6.0 + 12.0 * scene::grain(p));
  });
}

DepthCheckSettings planned_at(double depth) {
  DepthCheckSettings settings;
  settings.expected = Millimetres(depth);
  settings.tip_offset = TipOffset{"scene", "scene", Millimetres(0.0), Millimetres(0.05)};
  return settings;
}

Volume planning_scene() {
  return scene::imaged(scene::grid(1.0, 2.0), [](const Point& p) { return scene::tissue(p); });
}

// Two planes that contain the needle, and one across it.
std::vector<Grid> three_planes(int slices) {
  const Direction across = scene::kAxis.unitOrthogonal(), up = scene::kAxis.cross(across);
  return {slices_in(scene::kAxis, across, slices), slices_in(scene::kAxis, up, slices),
          slices_in(across, up, slices)};
}

TEST(Planes, ThreeOrthogonalSlicesShowDepthPlaceAndAngle) {
  std::vector<Volume> after;
  for (const Grid& grid : three_planes(1)) after.push_back(imaged_with_needle(grid, kTip_mm));
  const Volume first = planning_scene();
  const std::clock_t start = std::clock();
  const DepthCheck check = check_depth(first, after, scene::kEntry, scene::kAxis, planned_at(kTip_mm));
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  RecordProperty("cpu_s", std::to_string(seconds));
  EXPECT_EQ(check.verdict, DepthVerdict::Accept) << check.reason;
  EXPECT_NEAR(check.depth.value, kTip_mm, 0.5);
  EXPECT_NEAR(check.lateral_mm, 0.0, 0.5);
  EXPECT_NEAR(check.shift_mm[0], kShift.x(), 0.5);
  EXPECT_NEAR(check.shift_mm[1], kShift.y(), 0.5);
  EXPECT_NEAR(check.shift_mm[2], kShift.z(), 0.5);
}

TEST(Planes, ThreeOrthogonalSlicesRejectWhatIsElsewhere) {
  std::vector<Volume> after;
  for (const Grid& grid : three_planes(1)) after.push_back(imaged_with_needle(grid, kTip_mm));
  const Volume first = planning_scene();
  EXPECT_EQ(check_depth(first, after, scene::kEntry, scene::kAxis, planned_at(kTip_mm + 8.0)).verdict,
            DepthVerdict::Reject);
  const Point beside = scene::kEntry + 5.0 * scene::kAxis.unitOrthogonal();
  EXPECT_NE(check_depth(first, after, beside, scene::kAxis, planned_at(kTip_mm)).verdict,
            DepthVerdict::Accept);
}

TEST(Planes, ASlabOfThreeSlicesShowsTheDepth) {
  const std::vector<Volume> after{imaged_with_needle(three_planes(3).front(), kTip_mm)};
  const DepthCheck check =
      check_depth(planning_scene(), after, scene::kEntry, scene::kAxis, planned_at(kTip_mm));
  EXPECT_NE(check.verdict, DepthVerdict::Reject) << check.reason;
  EXPECT_TRUE(check.tip_found) << check.reason;
  EXPECT_NEAR(check.depth.value, kTip_mm, 0.7);
}

// Slices of 5 mm; the needle lies `off_mm` from the middle of the outermost one, along its normal.
Grid thick_slices(int slices, double off_mm) {
  const Direction across = scene::kAxis.unitOrthogonal(), normal = scene::kAxis.cross(across);
  Grid g;
  g.size = {80, 80, slices};
  g.X_SI.linear() << scene::kAxis, across, 5.0 * normal;
  const Point centre = scene::kEntry + 12.0 * scene::kAxis - off_mm * normal;
  g.X_SI.translation() = centre - g.X_SI.linear() * Eigen::Vector3d(39.5, 39.5, 0.0);
  return g;
}

// As much of a needle lies in a slice on either side of its middle: a plan on the other side is no better.
TEST(Planes, ASliceDoesNotTellOnWhichSideOfItsMiddleTheNeedleLies) {
  const Direction normal = scene::kAxis.cross(scene::kAxis.unitOrthogonal());
  for (const double off : {2.0, 2.3, -2.2}) {
    const std::vector<Volume> after{imaged_with_needle(thick_slices(1, off), kTip_mm)};
    const Point mirrored = scene::kEntry - 2.0 * off * normal;
    for (const Point& planned : {scene::kEntry, mirrored}) {
      const DepthCheck check =
          check_depth(planning_scene(), after, planned, scene::kAxis, planned_at(kTip_mm));
      EXPECT_NE(check.verdict, DepthVerdict::Accept) << off << ": " << check.reason;
      if (check.tip_found) {
        EXPECT_GT(check.lateral_sigma_mm, 1.0) << off << ": " << check.reason;
      }
    }
  }
}

TEST(Planes, ANeedleAtASlabsEdgeIsNotPutBesideThePlan) {
  for (const double off : {-2.2, -1.6, -1.0}) {
    const std::vector<Volume> after{imaged_with_needle(thick_slices(2, off), kTip_mm)};
    const DepthCheck check =
        check_depth(planning_scene(), after, scene::kEntry, scene::kAxis, planned_at(kTip_mm));
    EXPECT_NE(check.verdict, DepthVerdict::Reject) << off << ": " << check.reason;
  }
}

TEST(Planes, NeverAcceptASliceWithoutNeedle) {
  verifies("R-60");
  for (const Grid& grid : three_planes(1)) {
    const std::vector<Volume> after{scene::imaged(
        grid, [](const Point& p) { return std::abs(scene::tissue(p - kShift) + 12.0 * scene::grain(p)); })};
    const DepthCheck check =
        check_depth(planning_scene(), after, scene::kEntry, scene::kAxis, planned_at(kTip_mm));
    EXPECT_NE(check.verdict, DepthVerdict::Accept) << check.reason;
  }
}

}  // namespace
}  // namespace biopsy::imaging
