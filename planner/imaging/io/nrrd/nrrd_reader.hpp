// NRRD images (.nrrd, .nrrd.gz, .nhdr with the data in a file beside it; raw or gzip; either byte order).
#pragma once

#include <filesystem>

#include "planner/imaging/io/nrrd/nrrd_header.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

// By name (.nrrd, .nrrd.gz, .nhdr).
bool looks_like_nrrd(const std::filesystem::path& file);

// The grid in LPS mm, format, files and warnings, without the voxels. Throws ConfigError naming file and
// reason.
Volume read_nrrd_header(const std::filesystem::path& file);

// The same with the voxels as stored. A slab has fewer slices (k) than a volume.
Volume read_nrrd(const std::filesystem::path& file, int slices_min = kSizeMin);

// The same of a header that was read; of layers `header.layers` numbers a voxel, together.
Volume read_nrrd_layers(const std::filesystem::path& file, const NrrdHeader& header);

}  // namespace biopsy::imaging
