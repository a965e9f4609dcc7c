// The header of an NRRD image (teem.sourceforge.net/nrrd/format.html), read strictly: a field that is not
// understood, or given twice, is refused rather than guessed at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "planner/imaging/io/byte_source.hpp"
#include "planner/imaging/io/voxel_type.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

struct NrrdHeader {
  Grid grid;  // LPS mm
  VoxelCoding coding;
  ByteSource::Packing packing = ByteSource::Packing::Plain;
  std::filesystem::path data_file;  // the header's own file unless the data are detached
  std::uint64_t data_offset = 0;    // bytes into data_file as it lies on the disk
  std::uint64_t data_skip = 0;      // unpacked bytes before the data: the header of a file packed as a whole
};

// Throws ConfigError naming file and reason: not NRRD, other than three spatial dimensions, no or unknown
// anatomical space, missing or bad directions or origin, colour, vectors, unsupported encoding, units other
// than mm.
NrrdHeader read_nrrd_header_fields(const std::filesystem::path& file);

}  // namespace biopsy::imaging
