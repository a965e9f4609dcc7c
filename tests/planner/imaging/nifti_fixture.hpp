// NIfTI-1 files for tests, byte by byte from the header's layout.
#pragma once

#include <nifti/nifti1.h>
#include <nifti/nifti2.h>
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

// The image of nifti_header() as NIfTI-2, byte by byte: offsets of its fields from nifti2.h.
inline std::string nifti2_content(bool swapped) {
  std::string content(544, '\0');
  const auto put = [&](std::size_t at, auto value) {
    char bytes[sizeof(value)];
    std::memcpy(bytes, &value, sizeof(value));
    if (swapped) std::reverse(bytes, bytes + sizeof(value));
    std::copy(bytes, bytes + sizeof(value), content.begin() + static_cast<std::ptrdiff_t>(at));
  };
  put(0, std::int32_t{540});
  content.replace(4, 8, std::string("n+2\0\r\n\x1a\n", 8));
  put(12, std::int16_t{DT_INT16}), put(14, std::int16_t{16});
  const std::int64_t dim[8] = {3, 4, 5, 6, 1, 1, 1, 1};
  const double pixdim[8] = {1, 1, 2, 3, 0, 0, 0, 0};
  for (std::size_t n = 0; n < 8; ++n) put(16 + 8 * n, dim[n]), put(104 + 8 * n, pixdim[n]);
  put(168, std::int64_t{544});
  put(348, std::int32_t{1});  // sform
  const double rows[12] = {1, 0, 0, 10, 0, 2, 0, 20, 0, 0, 3, 30};
  for (std::size_t n = 0; n < 12; ++n) put(400 + 8 * n, rows[n]);
  put(500, std::int32_t{NIFTI_UNITS_MM});
  for (int n = 0; n < 120; ++n) {
    content.resize(content.size() + 2);
    put(content.size() - 2, static_cast<std::int16_t>(n - 10));
  }
  return content;
}

inline void write_gzip(const std::filesystem::path& file, const std::string& content) {
  gzFile out = gzopen(file.c_str(), "wb");
  gzwrite(out, content.data(), static_cast<unsigned>(content.size()));
  gzclose(out);
}

}  // namespace biopsy::imaging
