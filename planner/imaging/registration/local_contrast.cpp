#include "planner/imaging/registration/local_contrast.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "planner/imaging/registration/region.hpp"

namespace biopsy::imaging {
namespace {

constexpr double kHalf_mm = 20.0;  // half a side of the box that is local: wider than the mask
constexpr double kLeast = 0.15;    // of the mean signal: noise in air is no contrast

}  // namespace

Volume local_contrast(const Volume& volume, const std::optional<NeedleMask>& mask) {
  Volume result = volume;
  if (volume.voxels.empty()) return result;
  Volume one = volume, sum = volume, squares = volume;
  double total = 0.0;
  for (std::size_t n = 0; n < volume.voxels.size(); ++n) {
    total += static_cast<double>(volume.voxels[n]);
    one.voxels[n] = 1.0f;
    squares.voxels[n] = volume.voxels[n] * volume.voxels[n];
  }
  if (mask)
    for_each_voxel(rows_under(*mask, volume.grid), volume.grid, [&](const GridVoxel& voxel) {
      one.voxels[voxel.n] = sum.voxels[voxel.n] = squares.voxels[voxel.n] = 0.0f;
    });
  for (Volume* each : {&one, &sum, &squares}) *each = box_averaged(std::move(*each), kHalf_mm);
  const double least = kLeast * total / static_cast<double>(volume.voxels.size());
  for (std::size_t n = 0; n < result.voxels.size(); ++n) {
    const double asked = std::max(static_cast<double>(one.voxels[n]), 1e-3);
    const double mean = static_cast<double>(sum.voxels[n]) / asked;
    const double variance = std::max(static_cast<double>(squares.voxels[n]) / asked - mean * mean, 0.0);
    result.voxels[n] = static_cast<float>((static_cast<double>(volume.voxels[n]) - mean) /
                                          std::sqrt(variance + least * least + 1e-12));
  }
  return result;
}

}  // namespace biopsy::imaging
