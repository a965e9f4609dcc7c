// MetaImage (.mha, .mhd with the data in a file beside it; raw or zlib; either byte order), as ITK writes it.
#pragma once

#include <filesystem>

#include "planner/imaging/io/grid_rules.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

// By name (.mha, .mhd).
bool looks_like_metaimage(const std::filesystem::path& file);

// The grid in LPS mm, format, files and warnings, without the voxels. ITK's world is LPS; Offset (also named
// Position or Origin) is the first voxel's centre, each row of TransformMatrix the direction of one axis.
// Throws ConfigError naming file and reason: other than three dimensions, no spacing, offset or matrix,
// several channels, data in several files, text instead of binary data, a field given twice.
Volume read_metaimage_header(const std::filesystem::path& file);

// The same with the voxels as stored. A slab has fewer slices (k) than a volume.
Volume read_metaimage(const std::filesystem::path& file, int slices_min = kSizeMin);

}  // namespace biopsy::imaging
