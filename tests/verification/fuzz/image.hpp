// Any bytes as an image file: a sound volume, or a refusal.
#pragma once

#include "planner/imaging/io/read_volume.hpp"
#include "planner/imaging/io/series_list.hpp"
#include "tests/verification/fuzz/target.hpp"

namespace biopsy::fuzz {

inline void read_image(const std::string& name, Bytes bytes) {
  const std::filesystem::path file = as_file(name, bytes);
  reads_or_refuses([&] { imaging::list_series(file); });
  reads_or_refuses([&] {
    const Volume volume = imaging::read_volume(file);
    claim(volume.voxels.size() == volume.grid.voxel_count(), "as many voxels as the grid says");
    claim(volume.grid.size.minCoeff() >= 3, "three voxels along every axis");
    claim(volume.grid.X_SI.matrix().allFinite(), "a place in the scanner");
  });
}

}  // namespace biopsy::fuzz
