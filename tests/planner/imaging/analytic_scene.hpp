// Images made from a formula, so that the truth is known without any simulator.
#pragma once

#include <cmath>
#include <vector>

#include "robot/msg/volume.hpp"

namespace biopsy::imaging::scene {

// The needle enters the scene here.
inline const Point kEntry(-18.0, 3.0, -4.0);
inline const Direction kAxis = Direction(1.0, 0.25, 0.3).normalized();

// A sum of soft bright blobs on a grey ground: something to register on, everywhere above zero.
inline double tissue(const Point& p) {
  double value = 300.0;
  for (int n = 0; n < 40; ++n) {
    const Point centre(35.0 * std::sin(12.9 * n + 0.3), 35.0 * std::sin(7.7 * n + 1.1),
                       30.0 * std::sin(4.3 * n + 2.2));
    const double width = 3.0 + 2.0 * std::sin(3.1 * n);
    value += (n % 3 ? 250.0 : -120.0) * std::exp(-0.5 * (p - centre).squaredNorm() / (width * width));
  }
  return std::max(value, 60.0);
}

// 80 x 80 x 72 mm about the origin, turned by 12 degrees; slices `thick` apart.
inline Grid grid(double pixel_mm, double slice_mm) {
  Grid g;
  g.size = Eigen::Vector3d(80.0 / pixel_mm, 80.0 / pixel_mm, 72.0 / slice_mm).array().round().cast<int>();
  g.X_SI.linear() = Eigen::AngleAxisd(0.21, Direction(0.2, 1.0, 0.4).normalized()).toRotationMatrix() *
                    Eigen::Vector3d(pixel_mm, pixel_mm, slice_mm).asDiagonal();
  g.X_SI.translation() = -(g.X_SI.linear() * (0.5 * (g.size.cast<double>().array() - 1.0)).matrix());
  return g;
}

template <class Signal>
Volume imaged(const Grid& g, const Signal& signal) {
  Volume volume;
  volume.grid = g;
  volume.voxels.reserve(g.voxel_count());
  for (int k = 0; k < g.size.z(); ++k)
    for (int j = 0; j < g.size.y(); ++j)
      for (int i = 0; i < g.size.x(); ++i)
        volume.voxels.push_back(static_cast<float>(signal(g.X_SI * Eigen::Vector3d(i, j, k))));
  return volume;
}

// Repeatable, roughly normal disturbance of a place.
inline double grain(const Point& p) {
  double sum = 0.0;
  for (int n = 1; n <= 6; ++n) {
    const double x = std::sin(p.dot(Eigen::Vector3d(127.1, 311.7, 74.7)) * n + 3.0 * n) * 43758.5453;
    sum += x - std::floor(x) - 0.5;
  }
  return sum * std::sqrt(2.0);
}

// What is left of the signal beside a straight void that comes from behind `entry` and ends `depth` along
// `axis`.
inline double left_by_needle(const Point& p, const Point& entry, const Direction& axis, double depth,
                             double radius, double loss = 0.95, double blur = 0.4) {
  const double t = (p - entry).dot(axis), from_axis = (p - entry - t * axis).norm();
  const auto inside = [&](double x) { return 0.5 * std::erfc(-x / (std::sqrt(2.0) * blur)); };
  return 1.0 - loss * inside(radius - from_axis) * inside(depth - t);
}

}  // namespace biopsy::imaging::scene
