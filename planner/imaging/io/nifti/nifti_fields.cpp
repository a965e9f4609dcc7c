#include "planner/imaging/io/nifti/nifti_fields.hpp"

#include <nifti/nifti1.h>
#include <nifti/nifti2.h>

#include <algorithm>
#include <cstring>
#include <span>

#include "robot/common/config_error.hpp"

// The layout of the header comes from the library; its loader is not used, because it trusts the header when
// it allocates.

namespace biopsy::imaging {
namespace {

constexpr int kBytes1 = 348, kBytes2 = 540;
static_assert(sizeof(nifti_1_header) == kBytes1 && sizeof(nifti_2_header) == kBytes2);

template <class... Fields>
void swap_each(Fields&... fields) {
  const auto swap_one = [](auto& field) {
    const auto bytes = std::as_writable_bytes(std::span(&field, 1));
    std::reverse(bytes.begin(), bytes.end());
  };
  (swap_one(fields), ...);
}

// The fields this reader looks at; both versions name them alike.
template <class Raw>
void swap_bytes(Raw& raw) {
  for (auto& size : raw.dim) swap_each(size);
  for (auto& spacing : raw.pixdim) swap_each(spacing);
  for (auto* row : {raw.srow_x, raw.srow_y, raw.srow_z})
    for (int column = 0; column < 4; ++column) swap_each(row[column]);
  swap_each(raw.sizeof_hdr, raw.datatype, raw.bitpix, raw.vox_offset, raw.scl_slope, raw.scl_inter,
            raw.qform_code, raw.sform_code, raw.quatern_b, raw.quatern_c, raw.quatern_d, raw.qoffset_x,
            raw.qoffset_y, raw.qoffset_z);
  if constexpr (sizeof(raw.xyzt_units) > 1) swap_each(raw.xyzt_units);
}

template <class Raw>
NiftiFields fields_of(Raw raw, bool swapped) {
  if (swapped) swap_bytes(raw);
  NiftiFields out;
  out.swapped = swapped;
  std::copy(std::begin(raw.dim), std::end(raw.dim), out.dim.begin());
  std::copy(std::begin(raw.pixdim), std::end(raw.pixdim), out.pixdim.begin());
  out.datatype = raw.datatype, out.bitpix = raw.bitpix;
  out.qform_code = raw.qform_code, out.sform_code = raw.sform_code, out.xyzt_units = raw.xyzt_units;
  out.scl_slope = raw.scl_slope, out.scl_inter = raw.scl_inter;
  out.vox_offset = static_cast<double>(raw.vox_offset);
  out.quatern = {raw.quatern_b, raw.quatern_c, raw.quatern_d};
  out.qoffset = {raw.qoffset_x, raw.qoffset_y, raw.qoffset_z};
  std::size_t r = 0;
  for (const auto* row : {raw.srow_x, raw.srow_y, raw.srow_z}) std::copy(row, row + 4, out.srow[r++].begin());
  out.header_bytes = sizeof(raw);
  return out;
}

[[noreturn]] void refuse_nifti(const char* what, const std::string& file) {
  throw ConfigError(what, file, "convert the original DICOM series again, or give the DICOM series itself");
}

void check_magic(const char* magic, const char* one_file, const char* two_files, const std::string& file) {
  if (std::strncmp(magic, two_files, 4) == 0)
    throw ConfigError("header and image in two files are not read", file,
                      "convert to one .nii or .nii.gz file");
  if (std::strncmp(magic, one_file, 4) != 0)
    refuse_nifti("not a NIfTI file (no n+1 or n+2; an Analyze file has no geometry)", file);
}

}  // namespace

NiftiFields read_nifti_fields(ByteSource& source, const std::string& file) {
  nifti_1_header first;
  source.read(std::as_writable_bytes(std::span(&first, 1)));
  int size = first.sizeof_hdr;
  const bool swapped = size != kBytes1 && size != kBytes2;
  if (swapped) swap_each(size);
  if (size == kBytes1) {
    check_magic(first.magic, "n+1", "ni1", file);
    return fields_of(first, swapped);
  }
  if (size != kBytes2) refuse_nifti("not a NIfTI file", file);
  nifti_2_header second;
  std::memcpy(&second, &first, sizeof(first));
  source.read(std::as_writable_bytes(std::span(&second, 1)).subspan(sizeof(first)));
  check_magic(second.magic, "n+2", "ni2", file);
  if (std::memcmp(second.magic + 4, "\r\n\x1a\n", 4) != 0)
    refuse_nifti("damaged by a transfer as text: the end of its magic word is changed", file);
  NiftiFields fields = fields_of(second, swapped);
  fields.version = 2;
  return fields;
}

}  // namespace biopsy::imaging
