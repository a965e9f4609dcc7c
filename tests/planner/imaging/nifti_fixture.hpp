// NIfTI-1 files for tests, byte by byte from the header's layout.
#pragma once

#include <nifti/nifti1.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/scratch_folder.hpp"

namespace biopsy::imaging {

// 4 x 5 x 6 voxels of 16 bits, 1 x 2 x 3 mm, sform along RAS with the first voxel at RAS (10, 20, 30).
inline nifti_1_header nifti_header() {
  nifti_1_header header;
  std::memset(&header, 0, sizeof(header));
  header.sizeof_hdr = 348;
  const short dim[8] = {3, 4, 5, 6, 1, 1, 1, 1};
  const float pixdim[8] = {1, 1, 2, 3, 0, 0, 0, 0};
  std::copy(dim, dim + 8, header.dim);
  std::copy(pixdim, pixdim + 8, header.pixdim);
  header.datatype = DT_INT16;
  header.bitpix = 16;
  header.vox_offset = 352;
  header.xyzt_units = NIFTI_UNITS_MM;
  header.sform_code = 1;
  const float rows[3][4] = {{1, 0, 0, 10}, {0, 2, 0, 20}, {0, 0, 3, 30}};
  std::copy(rows[0], rows[0] + 4, header.srow_x);
  std::copy(rows[1], rows[1] + 4, header.srow_y);
  std::copy(rows[2], rows[2] + 4, header.srow_z);
  std::memcpy(header.magic, "n+1", 4);
  return header;
}

// Voxel n holds n - 10.
template <class Number = short>
std::string nifti_content(const nifti_1_header& header, std::size_t voxels = 4 * 5 * 6) {
  std::string content(reinterpret_cast<const char*>(&header), sizeof(header));
  content.resize(352, '\0');
  for (std::size_t n = 0; n < voxels; ++n) {
    const Number value = static_cast<Number>(static_cast<int>(n) - 10);
    content.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  return content;
}

inline void write_gzip(const std::filesystem::path& file, const std::string& content) {
  gzFile out = gzopen(file.c_str(), "wb");
  gzwrite(out, content.data(), static_cast<unsigned>(content.size()));
  gzclose(out);
}

}  // namespace biopsy::imaging
