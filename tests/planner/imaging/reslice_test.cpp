#include "planner/imaging/registration/reslice.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robot/common/config_error.hpp"
#include "tests/planner/imaging/analytic_scene.hpp"

namespace biopsy::imaging {
namespace {

double plane(const Point& p) {
  return 500.0 + 3.0 * p.x() - 2.0 * p.y() + 5.0 * p.z();
}

TEST(Sampler, IsExactForALinearFieldAndItsGradient) {
  const Volume volume = scene::imaged(scene::grid(1.1, 3.0), plane);
  const Sampler sampler(volume);
  double value;
  Eigen::Vector3d gradient;
  ASSERT_TRUE(sampler.at(Point(4.3, -7.1, 9.9), value, gradient));
  EXPECT_NEAR(value, plane({4.3, -7.1, 9.9}), 1e-3);
  EXPECT_NEAR(sampler.at(Point(4.3, -7.1, 9.9)), value, 1e-9);
  EXPECT_LT((gradient - Eigen::Vector3d(3.0, -2.0, 5.0)).norm(), 1e-3);
}

TEST(Sampler, HasNoValueOutsideTheVoxels) {
  const Volume volume = scene::imaged(scene::grid(1.1, 3.0), plane);
  EXPECT_TRUE(std::isnan(Sampler(volume).at(Point(60.0, 0.0, 0.0))));
  EXPECT_FALSE(std::isnan(Sampler(volume).at(volume.grid.X_SI * Eigen::Vector3d(-0.4, 0.0, 0.0))));
  EXPECT_TRUE(std::isnan(Sampler(volume).at(volume.grid.X_SI * Eigen::Vector3d(-0.6, 0.0, 0.0))));
}

TEST(NeedleFrame, IsRightHandedAndShowsTheNeedleWithinTheSlices) {
  const Grid grid = scene::grid(1.0, 3.0);
  for (const Direction& axis :
       {Direction(1, 2, 3), Direction(0, 0, 1), Direction(grid.X_SI.linear().col(2))}) {
    const NeedleFrame frame = needle_frame(grid, Point(1, 2, 3), axis);
    EXPECT_LT((frame.along.cross(frame.across) - frame.up).norm(), 1e-12);
    EXPECT_NEAR(frame.across.dot(grid.X_SI.linear().col(2).normalized()), 0.0, 1e-9);
    EXPECT_NEAR(frame.along.dot(axis.normalized()), 1.0, 1e-12);
    EXPECT_LT((frame.coordinates(frame.point(4, -5, 6)) - Eigen::Vector3d(4, -5, 6)).norm(), 1e-9);
  }
}

TEST(NeedleFrame, RefusesAnAxisWithoutLength) {
  EXPECT_THROW(needle_frame(scene::grid(1.0, 3.0), Point::Zero(), Direction::Zero()), ConfigError);
  EXPECT_THROW(needle_frame(scene::grid(1.0, 3.0), Point::Zero(), Direction(NAN, 0, 1)), ConfigError);
}

TEST(NeedleSlice, ShowsABrightSpotAtThePixelItsMappingNames) {
  const Point p_SE(-10.0, 4.0, 2.0);
  const Direction axis = Direction(1.0, 0.3, -0.2).normalized();
  const Grid grid = scene::grid(0.5, 1.0);
  const NeedleFrame frame = needle_frame(grid, p_SE, axis);
  const Point spot = frame.point(15.0, -6.0, 0.0);
  const Volume volume = scene::imaged(
      grid, [&](const Point& p) { return 100.0 + 900.0 * std::exp(-0.5 * (p - spot).squaredNorm()); });
  const NeedleSlice slice = slice_through_needle(volume, p_SE, axis, Millimetres(60.0), 240);
  int best = 0, x = 0, y = 0;
  double sum = 0.0;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (y = 0; y < 240; ++y)
    for (x = 0; x < 240; ++x) {
      const int grey = slice.picture.rgb[static_cast<std::size_t>(3 * (y * 240 + x))];
      best = std::max(best, grey);
      if (grey < 128) continue;
      sum += 1.0;
      centre += Eigen::Vector2d(x, y);
    }
  EXPECT_EQ(best, 255);
  EXPECT_LT((centre / sum - slice.pixel(15.0, -6.0)).norm() * slice.mm_per_pixel, 0.1);
  EXPECT_DOUBLE_EQ(slice.picture.mm_per_pixel, 0.25);
}

TEST(NeedleSlice, WindowIgnoresAFewFlares) {
  std::vector<float> values(10000, 100.0f);
  for (std::size_t n = 0; n < 5000; ++n) values[n] = 50.0f;
  for (std::size_t n = 0; n < 10; ++n) values[n] = 1e6f;
  EXPECT_LE(window_of(values).white, 100.0);
  EXPECT_GE(window_of(values).black, 50.0);
}

TEST(NeedleSlice, RefusesAPictureWithoutSize) {
  const Volume volume = scene::imaged(scene::grid(2.0, 4.0), plane);
  EXPECT_THROW(slice_through_needle(volume, Point::Zero(), Direction::UnitX(), Millimetres(0.0), 100),
               ConfigError);
  EXPECT_THROW(slice_through_needle(volume, Point::Zero(), Direction::UnitX(), Millimetres(50.0), 1),
               ConfigError);
}

}  // namespace
}  // namespace biopsy::imaging
