// Planes of the body. Inputs: a volume with one bright spot at a known place, in several orientations.
#include "planner/imaging/views/plane_views.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/safety/verifies.hpp"

namespace biopsy::imaging {
namespace {

// 40 x 40 x 20 voxels of 1 x 1 x 2 mm about (5, -10, 20) with a spot at `spot_S`.
Volume with_spot(const Point& spot_S, const Eigen::Matrix3d& turn) {
  Volume volume;
  volume.grid.size = Eigen::Vector3i(40, 40, 20);
  volume.grid.X_SI.linear() = turn * Eigen::Vector3d(1.0, 1.0, 2.0).asDiagonal();
  volume.grid.X_SI.translation() =
      Point(5, -10, 20) - volume.grid.X_SI.linear() * Eigen::Vector3d(19.5, 19.5, 9.5);
  for (int k = 0; k < 20; ++k)
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 40; ++i)
        volume.voxels.push_back(static_cast<float>(
            10.0 +
            1000.0 * std::exp(-0.2 * (volume.grid.X_SI * Eigen::Vector3d(i, j, k) - spot_S).squaredNorm())));
  return volume;
}

// The middle of what is white.
Eigen::Vector2d brightest(const Picture& picture) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0.0;
  for (int row = 0; row < picture.height; ++row)
    for (int column = 0; column < picture.width; ++column)
      if (picture.rgb[3 * static_cast<std::size_t>(row * picture.width + column)] == 255)
        sum += Eigen::Vector2d(column, row), ++count;
  return sum / count;
}

TEST(PlaneViews, FollowRadiologicalConvention) {
  verifies("R-61");
  for (double angle : {0.0, 0.5}) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Direction(1, 2, 3).normalized()).toRotationMatrix();
    const Point centre(5, -10, 20);
    // To the patient's left, behind and above the centre.
    for (const auto& [spot, name] : {std::pair(Point(4, 6, 0), "axial"), std::pair(Point(4, 0, 5), "coronal"),
                                     std::pair(Point(0, 6, 5), "sagittal")}) {
      const Volume volume = with_spot(centre + spot, turn);
      for (const PlaneView& view : plane_views(volume, centre, Millimetres(30.0))) {
        if (view.name != name) continue;
        const Eigen::Vector2d found = brightest(view.picture), middle(191.5, 191.5);
        EXPECT_LT((found - view.pixel(centre + spot)).norm(), 12.0) << name << " " << angle;
        // Left of the patient at the right of the picture; in a sagittal one the back is.
        EXPECT_GT(found.x(), middle.x()) << name;
        EXPECT_EQ(found.y() > middle.y(), view.name == "axial") << name;  // posterior down, superior up
        EXPECT_LT(view.window.black, view.window.white);
      }
    }
  }
}

TEST(PlaneViews, NameTheirCoordinateAndTheSliceTheyAre) {
  const Volume straight = with_spot(Point(5, -10, 20), Eigen::Matrix3d::Identity());
  const Point p_S = straight.grid.X_SI * Eigen::Vector3d(10, 30, 4);
  const auto views = plane_views(straight, p_S, Millimetres(30.0));
  EXPECT_EQ(views[0].slice, 5);
  EXPECT_EQ(views[0].slices, 20);
  EXPECT_EQ(views[1].slice, 31);
  EXPECT_EQ(views[2].slice, 11);
  EXPECT_EQ(views[0].coordinate(), "S 9.0 mm");
  EXPECT_EQ(views[1].coordinate(), "P 0.5 mm");
  EXPECT_EQ(views[2].coordinate(), "R 4.5 mm");
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.6, Direction(1, 2, 3).normalized()).toRotationMatrix();
  for (const PlaneView& view : plane_views(with_spot(p_S, turn), p_S, Millimetres(30.0)))
    EXPECT_EQ(view.slice, 0);
}

}  // namespace
}  // namespace biopsy::imaging
