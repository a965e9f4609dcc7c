#include "planner/imaging/io/nifti/nifti_reader.hpp"

#include <fmt/format.h>
#include <nifti/nifti1.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "planner/imaging/io/byte_source.hpp"
#include "planner/imaging/io/grid_rules.hpp"
#include "planner/imaging/io/voxel_type.hpp"
#include "robot/common/config_error.hpp"

// The layout of the header comes from the library; its loader is not used, because it trusts the header when
// it allocates. The voxels come through ByteSource, which trusts only the file.

namespace biopsy::imaging {
namespace {

constexpr const char* kNiftiRemedy =
    "convert the original DICOM series again, or give the DICOM series itself";

struct Header {
  nifti_1_header raw;
  bool swapped = false;
};

template <class... Fields>
void swap_each(Fields&... fields) {
  const auto swap_one = [](auto& field) {
    const auto bytes = std::as_writable_bytes(std::span(&field, 1));
    std::reverse(bytes.begin(), bytes.end());
  };
  (swap_one(fields), ...);
}

// The fields this reader looks at.
void swap_bytes(nifti_1_header& raw) {
  for (short& size : raw.dim) swap_each(size);
  for (float& spacing : raw.pixdim) swap_each(spacing);
  for (float* row : {raw.srow_x, raw.srow_y, raw.srow_z})
    for (int column = 0; column < 4; ++column) swap_each(row[column]);
  swap_each(raw.sizeof_hdr, raw.datatype, raw.bitpix, raw.vox_offset, raw.scl_slope, raw.scl_inter,
            raw.qform_code, raw.sform_code, raw.quatern_b, raw.quatern_c, raw.quatern_d, raw.qoffset_x,
            raw.qoffset_y, raw.qoffset_z);
}

Header read_header(ByteSource& source, const std::string& file) {
  Header header;
  source.read(std::as_writable_bytes(std::span(&header.raw, 1)));
  const int size_as_stored = header.raw.sizeof_hdr;
  header.swapped = size_as_stored != 348;
  if (header.swapped) swap_bytes(header.raw);
  if (size_as_stored == 540 || header.raw.sizeof_hdr == 540)
    throw ConfigError("NIfTI-2 is not read", file, "convert to NIfTI-1 (.nii or .nii.gz)");
  if (header.raw.sizeof_hdr != 348) throw ConfigError("not a NIfTI-1 file", file, kNiftiRemedy);
  if (std::memcmp(header.raw.magic, "ni1", 4) == 0)
    throw ConfigError("header and image in two files are not read", file,
                      "convert to one .nii or .nii.gz file");
  if (std::memcmp(header.raw.magic, "n+1", 4) != 0)
    throw ConfigError("not a NIfTI-1 file (no n+1; an Analyze file has no geometry)", file, kNiftiRemedy);
  return header;
}

Eigen::Vector3i size_of(const nifti_1_header& raw, const std::string& file) {
  if (raw.dim[0] < 1 || raw.dim[0] > 7)
    throw ConfigError(fmt::format("{} dimensions: the header is damaged", raw.dim[0]), file, kNiftiRemedy);
  for (int d = 4; d <= raw.dim[0]; ++d)
    if (raw.dim[d] > 1)
      throw ConfigError(fmt::format("4-D: {} volumes in one file", raw.dim[d]), file, "extract one volume");
  const auto along = [&](int d) { return d <= raw.dim[0] ? static_cast<int>(raw.dim[d]) : 1; };
  Eigen::Vector3i size(along(1), along(2), along(3));
  refuse_bad_size(size, file);
  return size;
}

std::optional<VoxelType> type_of(int datatype) {
  using enum VoxelType;
  static constexpr std::pair<int, VoxelType> kTypes[] = {
      {DT_UINT8, UInt8},     {DT_INT8, Int8},      {DT_INT16, Int16}, {DT_UINT16, UInt16},
      {DT_INT32, Int32},     {DT_UINT32, UInt32},  {DT_INT64, Int64}, {DT_UINT64, UInt64},
      {DT_FLOAT32, Float32}, {DT_FLOAT64, Float64}};
  for (const auto& [code, type] : kTypes)
    if (code == datatype) return type;
  return std::nullopt;
}

VoxelCoding coding_of(const Header& header, const std::string& file) {
  const int datatype = header.raw.datatype;
  const std::optional<VoxelType> type = type_of(datatype);
  if (!type) {
    const bool complex = datatype == DT_COMPLEX64 || datatype == DT_COMPLEX128 || datatype == DT_COMPLEX256;
    const bool colour = datatype == DT_RGB24 || datatype == DT_RGBA32;
    throw ConfigError(fmt::format("{} voxels (NIfTI datatype {}) are not read",
                                  complex  ? "complex"
                                  : colour ? "RGB colour"
                                           : "unknown",
                                  datatype),
                      file, "give an image with one real number a voxel");
  }
  if (header.raw.bitpix != static_cast<int>(8 * bytes_of(*type)))
    throw ConfigError(
        fmt::format("datatype {} with {} bits a voxel: the header is damaged", datatype, header.raw.bitpix),
        file, kNiftiRemedy);
  const double slope = header.raw.scl_slope, intercept = header.raw.scl_inter;
  if (!std::isfinite(slope) || !std::isfinite(intercept))
    throw ConfigError("scl_slope or scl_inter is not finite", file, kNiftiRemedy);
  return slope == 0.0 ? VoxelCoding{*type, header.swapped}
                      : VoxelCoding{*type, header.swapped, slope, intercept};
}

// NIfTI's world is RAS: the first two rows change sign.
AffineTransform lps_from_rows(const Eigen::Matrix<double, 3, 4>& ras) {
  AffineTransform X_SI;
  X_SI.matrix().topRows<3>() = Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal() * ras;
  X_SI.makeAffine();
  return X_SI;
}

AffineTransform sform_of(const nifti_1_header& raw) {
  Eigen::Matrix<double, 3, 4> rows;
  const float* srow[3] = {raw.srow_x, raw.srow_y, raw.srow_z};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) rows(r, c) = srow[r][c];
  return lps_from_rows(rows);
}

// Method 2 of nifti1.h: the quaternion's first part follows from unit length, pixdim[0] < 0 mirrors the third
// axis.
AffineTransform qform_of(const nifti_1_header& raw) {
  const Eigen::Vector3d bcd(raw.quatern_b, raw.quatern_c, raw.quatern_d);
  const Eigen::Quaterniond turn(std::sqrt(std::max(0.0, 1.0 - bcd.squaredNorm())), bcd.x(), bcd.y(), bcd.z());
  const Eigen::Vector3d scale(raw.pixdim[1], raw.pixdim[2],
                              raw.pixdim[0] < 0.0F ? -raw.pixdim[3] : raw.pixdim[3]);
  Eigen::Matrix<double, 3, 4> rows;
  rows.leftCols<3>() = turn.normalized().toRotationMatrix() * scale.asDiagonal();
  rows.col(3) = Eigen::Vector3d(raw.qoffset_x, raw.qoffset_y, raw.qoffset_z);
  return lps_from_rows(rows);
}

double furthest_corner_mm(const AffineTransform& a, const AffineTransform& b, const Eigen::Vector3i& size) {
  double furthest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d index(corner & 1 ? size.x() - 1 : 0, corner & 2 ? size.y() - 1 : 0,
                                corner & 4 ? size.z() - 1 : 0);
    furthest = std::max(furthest, (a * index - b * index).norm());
  }
  return furthest;
}

void place(const nifti_1_header& raw, const std::string& file, Volume& volume) {
  const bool sform = raw.sform_code > 0, qform = raw.qform_code > 0;
  if (!sform && !qform) throw ConfigError("no geometry: neither sform nor qform is set", file, kNiftiRemedy);
  const int units = raw.xyzt_units & 0x07;
  if (units != NIFTI_UNITS_MM && units != NIFTI_UNITS_UNKNOWN)
    throw ConfigError(
        units == NIFTI_UNITS_METER ? "the unit of length is metres, not mm" : "the unit of length is not mm",
        file, kNiftiRemedy);
  volume.grid.X_SI = sform ? sform_of(raw) : qform_of(raw);
  refuse_bad_grid(volume.grid, file);
  if (!sform || !qform) return;
  const double apart = furthest_corner_mm(volume.grid.X_SI, qform_of(raw), volume.grid.size);
  if (!(apart <= 0.1))
    volume.warnings.push_back(
        fmt::format("sform and qform place a corner of the image {:.2f} mm apart: the sform is used", apart));
}

struct OpenNifti {
  ByteSource source;
  VoxelCoding coding;
  Volume volume;
};

OpenNifti open_nifti(const std::filesystem::path& path) {
  const std::string file = path.string();
  const auto packing = begins_like_gzip(path) ? ByteSource::Packing::Gzip : ByteSource::Packing::Plain;
  OpenNifti open{ByteSource(path, packing), {}, {}};
  const Header header = read_header(open.source, file);
  open.volume.grid.size = size_of(header.raw, file);
  open.volume.format = "NIfTI";
  open.volume.files = {file};
  open.coding = coding_of(header, file);
  place(header.raw, file, open.volume);
  const float offset = header.raw.vox_offset;
  if (!(offset >= 352.0F && offset < 1e9F) || offset != std::floor(offset))
    throw ConfigError(fmt::format("the voxels are said to begin at byte {:g}", offset), file, kNiftiRemedy);
  open.source.skip(static_cast<std::uint64_t>(offset) - sizeof(header.raw));
  open.source.refuse_if_shorter_than(open.volume.grid.voxel_count() * bytes_of(open.coding.type));
  return open;
}

}  // namespace

bool looks_like_nifti(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return name.ends_with(".nii") || name.ends_with(".nii.gz");
}

Volume read_nifti_header(const std::filesystem::path& file) {
  return open_nifti(file).volume;
}

Volume read_nifti(const std::filesystem::path& file) {
  OpenNifti open = open_nifti(file);
  read_voxels(open.source, open.coding, file.string(), open.volume);
  if (open.source.rest() > 0)
    open.volume.warnings.push_back("the file holds more bytes than its header accounts for");
  return std::move(open.volume);
}

}  // namespace biopsy::imaging
