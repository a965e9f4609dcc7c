#include "planner/imaging/io/nifti/nifti_reader.hpp"

#include <fmt/format.h>
#include <nifti/nifti1.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "planner/imaging/io/byte_source.hpp"
#include "planner/imaging/io/grid_rules.hpp"
#include "planner/imaging/io/nifti/nifti_fields.hpp"
#include "planner/imaging/io/voxel_type.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::imaging {
namespace {

constexpr const char* kNiftiRemedy =
    "convert the original DICOM series again, or give the DICOM series itself";

Eigen::Vector3i size_of(const NiftiFields& raw, const std::string& file, int slices_min) {
  if (raw.dim[0] < 1 || raw.dim[0] > 7)
    throw ConfigError(fmt::format("{} dimensions: the header is damaged", raw.dim[0]), file, kNiftiRemedy);
  for (std::size_t d = 4; d <= static_cast<std::size_t>(raw.dim[0]); ++d)
    if (raw.dim[d] > 1)
      throw ConfigError(fmt::format("4-D: {} volumes in one file", raw.dim[d]), file, "extract one volume");
  const auto along = [&](std::size_t d) {  // beyond what is allowed, as something beyond
    return d <= static_cast<std::size_t>(raw.dim[0])
               ? static_cast<int>(std::clamp<std::int64_t>(raw.dim[d], -1, kSizeMax + 1))
               : 1;
  };
  Eigen::Vector3i size(along(1), along(2), along(3));
  refuse_bad_size(size, file, slices_min);
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

VoxelCoding coding_of(const NiftiFields& header, const std::string& file) {
  const int datatype = header.datatype;
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
  if (header.bitpix != static_cast<int>(8 * bytes_of(*type)))
    throw ConfigError(
        fmt::format("datatype {} with {} bits a voxel: the header is damaged", datatype, header.bitpix), file,
        kNiftiRemedy);
  const double slope = header.scl_slope, intercept = header.scl_inter;
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

AffineTransform sform_of(const NiftiFields& raw) {
  Eigen::Matrix<double, 3, 4> rows;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 4; ++c) rows(static_cast<int>(r), static_cast<int>(c)) = raw.srow[r][c];
  return lps_from_rows(rows);
}

// Method 2 of nifti1.h: the quaternion's first part follows from unit length, pixdim[0] < 0 mirrors the third
// axis.
AffineTransform qform_of(const NiftiFields& raw) {
  const Eigen::Vector3d bcd(raw.quatern[0], raw.quatern[1], raw.quatern[2]);
  const Eigen::Quaterniond turn(std::sqrt(std::max(0.0, 1.0 - bcd.squaredNorm())), bcd.x(), bcd.y(), bcd.z());
  const Eigen::Vector3d scale(raw.pixdim[1], raw.pixdim[2],
                              raw.pixdim[0] < 0.0 ? -raw.pixdim[3] : raw.pixdim[3]);
  Eigen::Matrix<double, 3, 4> rows;
  rows.leftCols<3>() = turn.normalized().toRotationMatrix() * scale.asDiagonal();
  rows.col(3) = Eigen::Vector3d(raw.qoffset[0], raw.qoffset[1], raw.qoffset[2]);
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

void place(const NiftiFields& raw, const std::string& file, int slices_min, Volume& volume) {
  const bool sform = raw.sform_code > 0, qform = raw.qform_code > 0;
  if (!sform && !qform) throw ConfigError("no geometry: neither sform nor qform is set", file, kNiftiRemedy);
  const int units = raw.xyzt_units & 0x07;
  if (units != NIFTI_UNITS_MM && units != NIFTI_UNITS_UNKNOWN)
    throw ConfigError(
        units == NIFTI_UNITS_METER ? "the unit of length is metres, not mm" : "the unit of length is not mm",
        file, kNiftiRemedy);
  volume.grid.X_SI = sform ? sform_of(raw) : qform_of(raw);
  refuse_bad_grid(volume.grid, file, slices_min);
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

OpenNifti open_nifti(const std::filesystem::path& path, int slices_min) {
  const std::string file = path.string();
  const auto packing = begins_like_gzip(path) ? ByteSource::Packing::Gzip : ByteSource::Packing::Plain;
  OpenNifti open{ByteSource(path, packing), {}, {}};
  const NiftiFields header = read_nifti_fields(open.source, file);
  open.volume.grid.size = size_of(header, file, slices_min);
  open.volume.format = "NIfTI";
  open.volume.files = {file};
  open.coding = coding_of(header, file);
  place(header, file, slices_min, open.volume);
  const double offset = header.vox_offset, least = static_cast<double>(header.header_bytes) + 4.0;
  if (!(offset >= least && offset < 1e9) || offset != std::floor(offset))
    throw ConfigError(fmt::format("the voxels are said to begin at byte {:g}", offset), file, kNiftiRemedy);
  open.source.skip(static_cast<std::uint64_t>(offset) - header.header_bytes);
  open.source.refuse_if_shorter_than(open.volume.grid.voxel_count() * bytes_of(open.coding.type));
  return open;
}

}  // namespace

bool looks_like_nifti(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return name.ends_with(".nii") || name.ends_with(".nii.gz");
}

Volume read_nifti_header(const std::filesystem::path& file) {
  return open_nifti(file, kSizeMin).volume;
}

Volume read_nifti(const std::filesystem::path& file, int slices_min) {
  OpenNifti open = open_nifti(file, slices_min);
  read_voxels(open.source, open.coding, file.string(), open.volume);
  if (open.source.rest() > 0)
    open.volume.warnings.push_back("the file holds more bytes than its header accounts for");
  return std::move(open.volume);
}

}  // namespace biopsy::imaging
