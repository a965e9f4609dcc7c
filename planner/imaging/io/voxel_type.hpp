// The number types an image file may hold, and their exact conversion to the floats of a Volume.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "planner/imaging/io/byte_source.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

enum class VoxelType : std::uint8_t {
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float32,
  Float64
};

std::size_t bytes_of(VoxelType type);

struct VoxelCoding {
  VoxelType type = VoxelType::Int16;
  bool swapped = false;  // byte order other than this machine's
  double slope = 1.0, intercept = 0.0;
};

// Reads all voxels of the grid, i fastest, as value * slope + intercept computed in double; integers up to
// 2^24 stay exact, larger ones are rounded to float and a warning says so. Memory grows with the bytes that
// really come. Throws ConfigError naming the file: truncated data, or a voxel that is not a finite float.
void read_voxels(ByteSource& source, const VoxelCoding& coding, const std::string& file, Volume& volume);

// Throws ConfigError when a voxel is not finite. Not repaired: a NaN spreads through interpolation into every
// sample beside it, and a zero in its place would be an intensity that was not measured. Scanners write none,
// so a file with one was processed, and its author must say what the voxel is.
void refuse_not_finite(const std::vector<float>& voxels, std::size_t from, const std::string& file);

}  // namespace biopsy::imaging
