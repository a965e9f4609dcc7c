#include "planner/imaging/registration/brightness.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "planner/imaging/registration/region.hpp"

namespace biopsy::imaging {
namespace {

double mean_of_known(const std::vector<float>& values) {
  double total = 0.0;
  std::size_t count = 0;
  for (float value : values)
    if (std::isfinite(value)) total += static_cast<double>(value), ++count;
  return total / static_cast<double>(std::max<std::size_t>(count, 1));
}

double mean_of(const Volume& volume) {
  return std::accumulate(volume.voxels.begin(), volume.voxels.end(), 0.0) /
         static_cast<double>(std::max<std::size_t>(volume.voxels.size(), 1));
}

// Sums over tissue of 1, a, b, a b and b b (a after, b before), by cell: brightness varies slowly.
struct Sums {
  Volume one, a, b, ab, bb;
  Eigen::Vector3i side;  // of a cell
};

Sums sums_by_cell(const Volume& after, const std::vector<VoxelRow>& rows, const std::vector<float>& before,
                  const NeedleMask& needle, double cell_mm) {
  const Grid& grid = after.grid;
  const Eigen::Vector3i side = (cell_mm / grid.spacing_mm().array()).floor().max(1.0).cast<int>();
  Volume none;
  none.grid = grid_of_cells(grid, side);
  none.voxels.assign(none.grid.voxel_count(), 0.0f);
  Sums sums{none, none, none, none, none, side};
  const double air = 0.3 * mean_of_known(before);  // its noise has a mean that is no brightness
  for_each_voxel(rows, grid, [&](const GridVoxel& voxel) {
    const float b = before[voxel.m], a = after.voxels[voxel.n];
    const bool tissue = static_cast<double>(b) > air;  // false where unknown
    if (!tissue || needle.covers(voxel.p_S)) return;
    const std::size_t cell = none.grid.index(voxel.i / side.x(), voxel.j / side.y(), voxel.k / side.z());
    sums.one.voxels[cell] += 1.0f;
    sums.a.voxels[cell] += a, sums.b.voxels[cell] += b;
    sums.ab.voxels[cell] += a * b, sums.bb.voxels[cell] += b * b;
  });
  const float share = 1.0f / static_cast<float>(side.prod());
  for (Volume* sum : {&sums.one, &sums.a, &sums.b, &sums.ab, &sums.bb})
    for (float& value : sum->voxels) value *= share;
  return sums;
}

struct Scale {
  double sigma_mm;  // over which brightness may change, one standard deviation
  double little;    // share of tissue in that reach that tells next to nothing
};

// One scale: what is left to explain.
BrightnessMap at_scale(Sums sums, const Scale& scale) {
  const double mean = mean_of(sums.b) / std::max(mean_of(sums.one), 1e-6);  // of tissue, before any smoothing
  for (Volume* sum : {&sums.one, &sums.a, &sums.b, &sums.ab, &sums.bb})
    *sum = smoothed(std::move(*sum), scale.sigma_mm);
  // Where tissue is all alike it tells a ratio, no slope.
  const double alike = std::pow(0.1 * mean, 2);
  BrightnessMap map{sums.one, sums.one, sums.side};
  for (std::size_t n = 0; n < map.slope.voxels.size(); ++n) {
    const double w = std::max(static_cast<double>(sums.one.voxels[n]), 0.0);
    const double a = std::max(static_cast<double>(sums.a.voxels[n]), 0.0),
                 b = std::max(static_cast<double>(sums.b.voxels[n]), 0.0);
    const double ratio = std::clamp((a + scale.little * mean) / (b + scale.little * mean), 0.1, 10.0);
    double slope = ratio, offset = 0.0;
    if (w > scale.little) {
      const double mean_b = b / w;
      const double covariance = static_cast<double>(sums.ab.voxels[n]) / w - a / w * mean_b,
                   variance = std::max(static_cast<double>(sums.bb.voxels[n]) / w - mean_b * mean_b, 0.0);
      slope = std::clamp((covariance + alike * ratio) / (variance + alike), 0.3 * ratio, 1.5 * ratio);
      offset = (ratio - slope) * mean_b;
    }
    map.slope.voxels[n] = static_cast<float>(slope);
    map.offset.voxels[n] = static_cast<float>(offset);
  }
  return map;
}

// The same sums for offset + slope . b in place of b.
Sums matched(Sums sums, const BrightnessMap& map) {
  for (std::size_t n = 0; n < sums.one.voxels.size(); ++n) {
    const float slope = map.slope.voxels[n], offset = map.offset.voxels[n];
    float &b = sums.b.voxels[n], &ab = sums.ab.voxels[n], &bb = sums.bb.voxels[n];
    bb = offset * (offset * sums.one.voxels[n] + 2.0f * slope * b) + slope * slope * bb;
    ab = offset * sums.a.voxels[n] + slope * ab;
    b = offset * sums.one.voxels[n] + slope * b;
  }
  return sums;
}

}  // namespace

BrightnessRow::BrightnessRow(const BrightnessMap& map, const Grid& after)
    : map_(map),
      i_(places(after.size.x(), map.side.x())),
      j_(places(after.size.y(), map.side.y())),
      k_(places(after.size.z(), map.side.z())) {}

std::vector<BrightnessRow::Place> BrightnessRow::places(int voxels, int side) {
  const int last = (voxels - 1) / side;
  std::vector<Place> all;
  for (int voxel = 0; voxel < voxels; ++voxel) {
    const double x = std::clamp((voxel + 0.5) / side - 0.5, 0.0, static_cast<double>(last));
    const int low = static_cast<int>(x);
    all.push_back({static_cast<std::size_t>(low), static_cast<std::size_t>(std::min(low + 1, last)),
                   static_cast<float>(x - low)});
  }
  return all;
}

void BrightnessRow::go_to(int j, int k) {
  const Grid& cells = map_.slope.grid;
  const Place &at_j = j_[static_cast<std::size_t>(j)], &at_k = k_[static_cast<std::size_t>(k)];
  const auto count = static_cast<std::size_t>(cells.size.x()),
             slice = count * static_cast<std::size_t>(cells.size.y());
  const auto mixed = [&](const Volume& of, std::vector<float>& row) {
    const float* const low = of.voxels.data() + at_k.low * slice;
    const float* const high = of.voxels.data() + at_k.high * slice;
    row.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto at = [&](const float* cell) {
        return cell[at_j.low * count + i] +
               at_j.f * (cell[at_j.high * count + i] - cell[at_j.low * count + i]);
      };
      row[i] = at(low) + at_k.f * (at(high) - at(low));
    }
  };
  mixed(map_.slope, slope_), mixed(map_.offset, offset_);
}

BrightnessMap learn_brightness(const Volume& after, const std::vector<VoxelRow>& rows,
                               const std::vector<float>& before, const NeedleMask& needle) {
  // Coils first; then what has an edge of its own, a saturation band or an organ with another contrast.
  constexpr Scale kCoils{.sigma_mm = 12.0, .little = 0.02}, kEdges{.sigma_mm = 5.0, .little = 0.05};
  const Sums sums = sums_by_cell(after, rows, before, needle, kEdges.sigma_mm / 4.0);
  BrightnessMap map = at_scale(sums, kCoils);
  const BrightnessMap rest = at_scale(matched(sums, map), kEdges);
  for (std::size_t n = 0; n < map.slope.voxels.size(); ++n) {
    map.slope.voxels[n] *= rest.slope.voxels[n];
    map.offset.voxels[n] = rest.offset.voxels[n] + rest.slope.voxels[n] * map.offset.voxels[n];
  }
  return map;
}

}  // namespace biopsy::imaging
