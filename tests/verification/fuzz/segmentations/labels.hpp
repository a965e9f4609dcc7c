// Any bytes as a label map: whole numbers on a sound grid, or a refusal.
#pragma once

#include <cmath>

#include "planner/imaging/io/labels.hpp"
#include "tests/verification/fuzz/target.hpp"

namespace biopsy::fuzz {

inline void read_label_map(const std::string& name, Bytes bytes) {
  const std::filesystem::path file = as_file(name, bytes);
  reads_or_refuses([&] {
    const imaging::LabelMap map = imaging::read_labels(file);
    claim(map.volume.voxels.size() == map.volume.grid.voxel_count(), "as many voxels as the grid says");
    claim(map.volume.grid.X_SI.matrix().allFinite(), "a place in the scanner");
    for (const float value : map.volume.voxels)
      claim(value >= 0.0F && value < 1e6F && value == std::round(value), "whole numbers");
  });
}

}  // namespace biopsy::fuzz
