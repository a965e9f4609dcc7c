// The header of an NRRD image (teem.sourceforge.net/nrrd/format.html), read strictly: a field that is not
// understood, or given twice, is refused rather than guessed at.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "planner/imaging/io/byte_source.hpp"
#include "planner/imaging/io/grid_rules.hpp"
#include "planner/imaging/io/voxel_type.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

struct NrrdHeader {
  Grid grid;       // LPS mm
  int layers = 1;  // volumes on the grid: of each voxel one number a layer, together
  VoxelCoding coding;
  ByteSource::Packing packing = ByteSource::Packing::Plain;
  std::filesystem::path data_file;  // the header's own file unless the data are detached
  std::uint64_t data_offset = 0;    // bytes into data_file as it lies on the disk
  std::uint64_t data_skip = 0;      // unpacked bytes before the data: the header of a file packed as a whole
  std::map<std::string, std::string> keys;  // of the program that wrote it: "key:=value"
};

// A list of volumes on one grid, as in a segmentation whose segments overlap.
enum class NrrdLayers { Refused, Allowed };

// Throws ConfigError naming file and reason: not NRRD, other than three spatial dimensions (and, where it is
// allowed, a list before them), no or unknown
// anatomical space, missing or bad directions or origin, colour, vectors, unsupported encoding, units other
// than mm.
NrrdHeader read_nrrd_header_fields(const std::filesystem::path& file, NrrdLayers layers = NrrdLayers::Refused,
                                   int slices_min = kSizeMin);

}  // namespace biopsy::imaging
