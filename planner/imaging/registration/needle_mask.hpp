// The voxels about a needle's path, found row by row: what lies elsewhere in a large image costs nothing.
#pragma once

#include <vector>

#include "planner/imaging/registration/reslice.hpp"

namespace biopsy::imaging {

// Places within `radius` of the line through the needle, between two depths.
struct NeedleMask {
  NeedleFrame frame;
  double from_mm = 0.0, to_mm = 0.0, radius_mm = 0.0;

  bool covers(const Point& p_S) const { return covers_coordinates(frame.coordinates(p_S)); }
  bool covers_coordinates(const Eigen::Vector3d& c) const {
    return c.x() >= from_mm && c.x() <= to_mm && c.y() * c.y() + c.z() * c.z() <= radius_mm * radius_mm;
  }
};

// Voxels (i, j, k) to (i + count - 1, j, k) of a grid; `first`: how many voxels the rows before have.
struct VoxelRow {
  int i = 0, j = 0, k = 0, count = 0;
  std::size_t first = 0;
};

// What the mask covers, in the order of the voxels.
std::vector<VoxelRow> rows_under(const NeedleMask& mask, const Grid& grid);
std::vector<VoxelRow> all_rows(const Grid& grid);
inline std::size_t voxel_count(const std::vector<VoxelRow>& rows) {
  return rows.empty() ? 0 : rows.back().first + static_cast<std::size_t>(rows.back().count);
}

struct GridVoxel {
  int i, j, k;
  std::size_t n, m;  // index in the grid and among the rows' voxels
  Point p_S;         // centre
};

// Calls use(voxel) for each voxel of the rows.
template <class Use>
void for_each_voxel(const std::vector<VoxelRow>& rows, const Grid& grid, const Use& use) {
  const Eigen::Vector3d step = grid.X_SI.linear().col(0);
  for (const VoxelRow& row : rows) {
    const Point start = grid.X_SI * Eigen::Vector3d(0, row.j, row.k);
    std::size_t n = grid.index(row.i, row.j, row.k), m = row.first;
    for (int i = row.i; i < row.i + row.count; ++i, ++n, ++m)
      use(GridVoxel{i, row.j, row.k, n, m, start + i * step});
  }
}

}  // namespace biopsy::imaging
