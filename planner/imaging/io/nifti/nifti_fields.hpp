// The header of a NIfTI file, version 1 or 2, as one set of fields.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "planner/imaging/io/byte_source.hpp"

namespace biopsy::imaging {

struct NiftiFields {
  int version = 1;
  bool swapped = false;  // byte order other than this machine's
  std::array<std::int64_t, 8> dim{};
  std::array<double, 8> pixdim{};
  int datatype = 0, bitpix = 0, qform_code = 0, sform_code = 0, xyzt_units = 0;
  double scl_slope = 0.0, scl_inter = 0.0, vox_offset = 0.0;
  std::array<double, 3> quatern{}, qoffset{};
  std::array<std::array<double, 4>, 3> srow{};
  std::uint64_t header_bytes = 348;
};

// Reads the header from the beginning of a file. Throws ConfigError naming `file`: truncated, no NIfTI,
// header and image in two files.
NiftiFields read_nifti_fields(ByteSource& source, const std::string& file);

}  // namespace biopsy::imaging
