#include "planner/imaging/depth_check/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
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

// Places in an after voxel, in mm from its centre: as many as it is larger than the before image's
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
        places.push_back(
            after.X_SI.linear() *
            ((Eigen::Vector3d(i, j, k).array() + 0.5) / count.cast<double>().array() - 0.5).matrix());
  return places;
}

// By how much linear interpolation may err, from the second differences of the voxels: an eighth of one in a
// smooth image (Taylor), all of it where something as thin as a voxel lies between two.
float interpolation_error(const Volume& before, const Eigen::Vector3d& index) {
  constexpr float kOfSecondDifference = 1.0f / 6.0f;
  const Eigen::Vector3i& size = before.grid.size;
  const Eigen::Vector3i at = index.array().round().cast<int>().max(0).min(size.array() - 1);
  const float* const voxel = before.voxels.data() + before.grid.index(at.x(), at.y(), at.z());
  float sum = 0.0f;
  std::ptrdiff_t stride = 1;
  for (int a = 0; a < 3; ++a) {
    const float bend =
        voxel[at[a] > 0 ? -stride : 0] - 2.0f * *voxel + voxel[at[a] + 1 < size[a] ? stride : 0];
    sum += bend * bend;
    stride *= size[a];
  }
  return kOfSecondDifference * std::sqrt(sum);
}

}  // namespace

bool Prediction::knows(const Eigen::Vector3i& voxel) const {
  const auto ends_before = [](const VoxelRow& row, const Eigen::Vector3i& v) {
    return std::pair(row.k, row.j) < std::pair(v.z(), v.y());
  };
  const auto row = std::lower_bound(rows.begin(), rows.end(), voxel, ends_before);
  if (row == rows.end() || row->j != voxel.y() || row->k != voxel.z()) return false;
  const int at = voxel.x() - row->i;
  return at >= 0 && at < row->count && std::isfinite(value[row->first + static_cast<std::size_t>(at)]);
}

Prediction predicted(const Volume& before, const Volume& after, const TissueMotion& motion,
                     const NeedleMask& needle, const NeedleMask& reach) {
  const Grid& grid = after.grid;
  Prediction result;
  result.rows = rows_under(reach, grid);
  for (std::vector<float>* of : {&result.value, &result.steepness, &result.interpolation})
    of->reserve(voxel_count(result.rows));
  const Sampler sampler(before);
  const AffineTransform X_IS = before.grid.X_SI.inverse();
  const std::vector<Eigen::Vector3d> places = places_in_voxel(before.grid, grid);
  for_each_voxel(result.rows, grid, [&](const GridVoxel& voxel) {
    double value = std::numeric_limits<double>::quiet_NaN();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    const Point p_before = motion.before(voxel.p_S);
    const Eigen::Vector3d index = X_IS * p_before;
    if (well_inside(before.grid, index)) sampler.at(p_before, value, gradient);
    if (places.size() > 1 && std::isfinite(value)) {
      double sum = 0.0;
      int count = 0;
      for (const Eigen::Vector3d& place : places) {
        const double one = sampler.at(motion.before(voxel.p_S + place));
        if (std::isfinite(one)) sum += one, ++count;
      }
      if (count > 0) value = sum / count;
    }
    result.value.push_back(static_cast<float>(value));
    result.steepness.push_back(static_cast<float>(gradient.norm()));
    result.interpolation.push_back(interpolation_error(before, index));
  });
  const BrightnessMap map = learn_brightness(after, result.rows, result.value, needle);
  BrightnessRow brightness(map, grid);
  for (const VoxelRow& row : result.rows) {
    brightness.go_to(row.j, row.k);
    std::size_t m = row.first;
    for (int i = row.i; i < row.i + row.count; ++i, ++m) {
      const float gain = brightness.slope(i);
      if (std::isfinite(result.value[m]))
        result.value[m] = std::max(brightness.offset(i) + gain * result.value[m], 0.0f);
      result.steepness[m] *= gain;
      result.interpolation[m] *= gain;
    }
  }
  return result;
}

}  // namespace biopsy::imaging
