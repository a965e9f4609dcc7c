#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <functional>

#include "planner/imaging/depth_check/find_tip.hpp"
#include "tests/planner/imaging/analytic_scene.hpp"

namespace biopsy::imaging {
namespace {

struct Needle {
  double depth = 20.0, radius = 1.5;
  Point entry = scene::kEntry;
  Direction axis = scene::kAxis;
};

TipFinding found_with(
    const Grid& grid, const Needle& needle, double loss = 0.95, double noise = 15.0,
    const std::function<double(const Point&)>& traces = [](const Point&) { return 1.0; }) {
  const Volume before = scene::imaged(grid, [&](const Point& p) { return scene::tissue(p) * traces(p); });
  const Volume after = scene::imaged(grid, [&](const Point& p) {
    // A voxel sees the mean over its thickness.
    double left = 0.0;
    for (int n = 0; n < 6; ++n)
      left += scene::left_by_needle(p + grid.X_SI.linear().col(2) * ((n + 0.5) / 6.0 - 0.5), needle.entry,
                                    needle.axis, needle.depth, needle.radius, loss);
    return std::abs(scene::tissue(p) * traces(p) * left / 6.0 + noise * scene::grain(p));
  });
  RegistrationResult still;
  const NeedleFrame frame = needle_frame(grid, scene::kEntry, scene::kAxis);
  CorridorSettings path;
  path.to_mm = 50.0;
  const Corridor corridor = needle_corridor(before, after, still, frame, path);
  SearchReach search;
  search.depth_max_mm = 50.0;
  return corridor.voxels.empty() ? TipFinding{} : find_tip(corridor, search);
}

bool stands_out(const TipFinding& tip) {
  return tip.evidence > 6.0 && tip.control_places > 0;
}

TEST(FindTip, ReadsTheDepthOfThinAndWideVoids) {
  for (double radius : {0.8, 1.5, 3.0, 6.0}) {
    const TipFinding tip = found_with(scene::grid(0.8, 2.4), {20.0, radius});
    EXPECT_TRUE(stands_out(tip)) << radius << " evidence " << tip.evidence << " loss " << tip.loss
                                 << " control places " << tip.control_places << " depth " << tip.depth_mm
                                 << " radius " << tip.radius_mm;
    EXPECT_NEAR(tip.depth_mm, 20.0, 0.3) << radius;
    EXPECT_LT(std::abs(tip.depth_mm - 20.0), 3.5 * tip.sigma_mm) << radius;
    EXPECT_NEAR(tip.radius_mm, radius, 0.25 * radius + 0.2);
    EXPECT_EQ(tip.gap_mm, 0.0);
  }
}

TEST(FindTip, ReadsTheDepthInCoarseVoxels) {
  for (double depth : {17.1, 18.3, 19.6, 21.0}) {
    const TipFinding tip = found_with(scene::grid(1.2, 3.6), {depth, 3.0});
    EXPECT_TRUE(stands_out(tip));
    EXPECT_NEAR(tip.depth_mm, depth, 0.6);
  }
}

TEST(FindTip, FollowsANeedleThatDeviatesAndTilts) {
  const NeedleFrame frame = needle_frame(scene::grid(0.8, 2.4), scene::kEntry, scene::kAxis);
  Needle bent{20.0, 1.5, frame.point(0.0, 1.6, -1.0), scene::kAxis};
  bent.axis = (scene::kAxis + 0.03 * frame.across).normalized();
  const TipFinding tip = found_with(scene::grid(0.8, 2.4), bent);
  EXPECT_NEAR(tip.depth_mm, 20.0 * bent.axis.dot(scene::kAxis), 0.3);
  EXPECT_NEAR(tip.beside_mm.value.x(), 1.6 + 20.0 * 0.03, 0.4);
  EXPECT_NEAR(tip.beside_mm.value.y(), -1.0, 0.4);
}

TEST(FindTip, IgnoresAnOldTrackAndBubblesThatAreInBothImages) {
  const NeedleFrame frame = needle_frame(scene::grid(0.8, 2.4), scene::kEntry, scene::kAxis);
  const auto traces = [&](const Point& p) {
    const Point bubble = frame.point(27.0, 0.5, 0.0);
    return scene::left_by_needle(p, frame.point(0.0, 4.5, 0.0), scene::kAxis, 35.0, 1.5, 0.8) *
           (1.0 - 0.9 * std::exp(-0.5 * (p - bubble).squaredNorm() / 4.0));
  };
  const TipFinding tip = found_with(scene::grid(0.8, 2.4), {20.0, 1.5}, 0.95, 15.0, traces);
  EXPECT_NEAR(tip.depth_mm, 20.0, 0.3);
  EXPECT_LT(std::abs(tip.beside_mm.value.x()), 1.0);
  const TipFinding nothing = found_with(scene::grid(0.8, 2.4), {20.0, 1.5}, 0.0, 15.0, traces);
  EXPECT_FALSE(stands_out(nothing));
}

TEST(FindTip, FindsNothingInNoiseAndSaysANeedleWouldHaveShown) {
  const TipFinding tip = found_with(scene::grid(0.8, 2.4), {20.0, 1.5}, 0.0);
  EXPECT_FALSE(stands_out(tip));
  EXPECT_GT(tip.visible, 6.0);
  EXPECT_LT(found_with(scene::grid(0.8, 2.4), {20.0, 1.5}, 0.0, 400.0).visible, 6.0);
}

TEST(FindTip, SeesThatAVoidGoesOnPastTheImagesEnd) {
  EXPECT_TRUE(found_with(scene::grid(0.8, 2.4), {300.0, 2.0}).at_end);
  EXPECT_FALSE(found_with(scene::grid(0.8, 2.4), {20.0, 2.0}).at_end);
}

// With roots as one maker's processors approximate them (rsqrtps), a depth that is barely accepted there is
// not accepted on another's.
TEST(FindTip, TakesSquareRootsToTheLastBit) {
  const Eigen::ArrayXf squares = Eigen::ArrayXf::LinSpaced(10'000, 1e-4f, 30.0f);
  const Eigen::ArrayXf roots = squares.sqrt();
  for (Eigen::Index i = 0; i < squares.size(); ++i) ASSERT_EQ(roots[i], std::sqrt(squares[i])) << squares[i];
}

}  // namespace
}  // namespace biopsy::imaging
