#include "planner/imaging/depth_check/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "planner/imaging/registration/brightness.hpp"

namespace biopsy::imaging {
namespace {

// The outermost layer has no neighbour to be interpolated with: it holds for a quarter of a voxel beyond.
bool well_inside(const Grid& grid, const Eigen::Vector3d& index) {
  constexpr double kBeyond = 0.25;
  return (index.array() >= -kBeyond).all() &&
         (index.array() <= grid.size.cast<double>().array() - 1.0 + kBeyond).all();
}

// Places in an after voxel, in voxels from its centre: as many as it is larger than the before image's
// voxels. One place alone would carry the noise of few before voxels.
std::vector<Eigen::Vector3d> places_in_voxel(const Grid& before, const Grid& after) {
  Eigen::Vector3i count;
  for (int a = 0; a < 3; ++a) {
    const Eigen::Vector3d side = after.X_SI.linear().col(a);
    const double before_mm = (before.X_SI.linear().transpose() * side.normalized()).cwiseAbs().sum();
    count[a] = std::clamp(static_cast<int>(std::lround(side.norm() / before_mm)), 1, 3);
  }
  std::vector<Eigen::Vector3d> places;
  for (int k = 0; k < count.z(); ++k)
    for (int j = 0; j < count.y(); ++j)
      for (int i = 0; i < count.x(); ++i)
        places.push_back((Eigen::Vector3d(i, j, k).array() + 0.5) / count.cast<double>().array() - 0.5);
  return places;
}

// By how much linear interpolation may err, from the second differences of the voxels: an eighth of one in a
// smooth image (Taylor), all of it where something as thin as a voxel lies between two.
float interpolation_error(const Volume& before, const Eigen::Vector3d& index) {
  constexpr float kOfSecondDifference = 1.0f / 6.0f;
  const Eigen::Vector3i last = before.grid.size.array() - 1, at = index.array().round().cast<int>();
  const auto voxel = [&](const Eigen::Vector3i& near) {
    const Eigen::Vector3i inside = near.cwiseMax(0).cwiseMin(last);
    return before.at(inside.x(), inside.y(), inside.z());
  };
  float sum = 0.0f;
  for (int a = 0; a < 3; ++a) {
    const Eigen::Vector3i step = Eigen::Vector3i::Unit(a);
    const float bend = voxel(at - step) - 2.0f * voxel(at) + voxel(at + step);
    sum += bend * bend;
  }
  return kOfSecondDifference * std::sqrt(sum);
}

}  // namespace

Prediction predicted(const Volume& before, const Volume& after, const TissueMotion& motion,
                     const NeedleMask& needle, const NeedleMask& reach) {
  Prediction result{after, after, after};
  const Sampler sampler(before);
  const AffineTransform X_IS = before.grid.X_SI.inverse();
  const Grid& grid = after.grid;
  const std::vector<Eigen::Vector3d> places = places_in_voxel(before.grid, grid);
  std::size_t n = 0;
  for (int k = 0; k < grid.size.z(); ++k)
    for (int j = 0; j < grid.size.y(); ++j)
      for (int i = 0; i < grid.size.x(); ++i, ++n) {
        double value = std::numeric_limits<double>::quiet_NaN();
        Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
        const Eigen::Vector3d centre(i, j, k);
        result.value.voxels[n] = std::numeric_limits<float>::quiet_NaN();
        if (!reach.covers(grid.X_SI * centre)) continue;
        const Point p_before = motion.before(grid.X_SI * centre);
        const Eigen::Vector3d index = X_IS * p_before;
        if (well_inside(before.grid, index)) sampler.at(p_before, value, gradient);
        if (places.size() > 1 && std::isfinite(value)) {
          double sum = 0.0;
          int count = 0;
          for (const Eigen::Vector3d& place : places) {
            const double one = sampler.at(motion.before(grid.X_SI * (centre + place)));
            if (std::isfinite(one)) sum += one, ++count;
          }
          if (count > 0) value = sum / count;
        }
        result.value.voxels[n] = static_cast<float>(value);
        result.steepness.voxels[n] = static_cast<float>(gradient.norm());
        result.interpolation.voxels[n] = interpolation_error(before, index);
      }
  const BrightnessMap map = learn_brightness(after, result.value, needle);
  const Sampler slope(map.slope), offset(map.offset);
  n = 0;
  for (int k = 0; k < grid.size.z(); ++k)
    for (int j = 0; j < grid.size.y(); ++j)
      for (int i = 0; i < grid.size.x(); ++i, ++n) {
        float& value = result.value.voxels[n];
        if (!std::isfinite(value)) continue;
        const Point p_S = grid.X_SI * Eigen::Vector3d(i, j, k);
        const auto gain = static_cast<float>(slope.at(p_S));
        value = std::max(static_cast<float>(offset.at(p_S)) + gain * value, 0.0f);
        result.steepness.voxels[n] *= gain;
        result.interpolation.voxels[n] *= gain;
      }
  return result;
}

}  // namespace biopsy::imaging
