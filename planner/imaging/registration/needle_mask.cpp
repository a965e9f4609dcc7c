#include "planner/imaging/registration/needle_mask.hpp"

#include <algorithm>
#include <cmath>

namespace biopsy::imaging {
namespace {

struct Interval {
  double low, high;

  void keep(double a, double b) {
    low = std::max(low, std::min(a, b)), high = std::min(high, std::max(a, b));
  }
  void empty() { high = low - 1.0; }
};

// Where the line start + i step lies under the mask; both in needle coordinates.
Interval part_under(const NeedleMask& mask, const Eigen::Vector3d& start, const Eigen::Vector3d& step,
                    int count) {
  constexpr double kParallel = 1e-9;  // mm per voxel
  Interval part{0.0, count - 1.0};
  if (std::abs(step.x()) > kParallel)
    part.keep((mask.from_mm - start.x()) / step.x(), (mask.to_mm - start.x()) / step.x());
  else if (start.x() < mask.from_mm || start.x() > mask.to_mm)
    part.empty();
  const Eigen::Vector2d beside = start.tail<2>(), by = step.tail<2>();
  const double square = by.squaredNorm(), out = mask.radius_mm * mask.radius_mm;
  if (square > kParallel * kParallel) {
    const double nearest = -beside.dot(by) / square;
    const double left = out - (beside + nearest * by).squaredNorm();
    if (left < 0.0) part.empty();
    const double half = std::sqrt(std::max(left, 0.0) / square);
    part.keep(nearest - half, nearest + half);
  } else if (beside.squaredNorm() > out) {
    part.empty();
  }
  return part;
}

}  // namespace

std::vector<VoxelRow> rows_under(const NeedleMask& mask, const Grid& grid) {
  Eigen::Matrix3d axes;
  axes << mask.frame.along, mask.frame.across, mask.frame.up;
  const Eigen::Matrix3d steps = axes.transpose() * grid.X_SI.linear();
  const Eigen::Vector3d first = mask.frame.coordinates(grid.X_SI.translation());
  std::vector<VoxelRow> rows;
  for (int k = 0; k < grid.size.z(); ++k)
    for (int j = 0; j < grid.size.y(); ++j) {
      const Interval part =
          part_under(mask, first + j * steps.col(1) + k * steps.col(2), steps.col(0), grid.size.x());
      const double low = std::ceil(part.low), high = std::floor(part.high);
      if (low <= high)
        rows.push_back({static_cast<int>(low), j, k, static_cast<int>(high - low) + 1, voxel_count(rows)});
    }
  return rows;
}

std::vector<VoxelRow> all_rows(const Grid& grid) {
  std::vector<VoxelRow> rows;
  for (int k = 0; k < grid.size.z(); ++k)
    for (int j = 0; j < grid.size.y(); ++j) rows.push_back({0, j, k, grid.size.x(), voxel_count(rows)});
  return rows;
}

}  // namespace biopsy::imaging
