#include "planner/imaging/io/voxel_type.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "robot/common/config_error.hpp"

namespace biopsy::imaging {
namespace {

constexpr double kExactInFloat = 16777216.0;  // 2^24

// Appends the numbers in `bytes`; returns true when one of them was an integer too large to be exact.
template <class Number>
bool append(const std::vector<std::byte>& bytes, const VoxelCoding& coding, std::vector<float>& voxels) {
  bool rounded = false;
  std::byte raw[sizeof(Number)];
  for (std::size_t at = 0; at + sizeof(Number) <= bytes.size(); at += sizeof(Number)) {
    std::memcpy(raw, bytes.data() + at, sizeof(Number));
    if (coding.swapped) std::reverse(raw, raw + sizeof(Number));
    Number number;
    std::memcpy(&number, raw, sizeof(Number));
    const double value = static_cast<double>(number) * coding.slope + coding.intercept;
    if constexpr (std::is_integral_v<Number> && sizeof(Number) >= 4)
      rounded |= std::abs(value) > kExactInFloat;
    // Larger than a float can hold: infinite, and refused as such (the cast alone would be undefined).
    const bool too_large = std::abs(value) > static_cast<double>(std::numeric_limits<float>::max());
    voxels.push_back(too_large ? std::numeric_limits<float>::infinity() : static_cast<float>(value));
  }
  return rounded;
}

// Calls `visit` with a zero of the type's number.
template <class Visit>
auto with_number(VoxelType type, Visit&& visit) {
  switch (type) {
    case VoxelType::Int8:
      return visit(std::int8_t{});
    case VoxelType::UInt8:
      return visit(std::uint8_t{});
    case VoxelType::Int16:
      return visit(std::int16_t{});
    case VoxelType::UInt16:
      return visit(std::uint16_t{});
    case VoxelType::Int32:
      return visit(std::int32_t{});
    case VoxelType::UInt32:
      return visit(std::uint32_t{});
    case VoxelType::Int64:
      return visit(std::int64_t{});
    case VoxelType::UInt64:
      return visit(std::uint64_t{});
    case VoxelType::Float32:
      return visit(float{});
    case VoxelType::Float64:
      return visit(double{});
  }
  std::abort();
}

}  // namespace

std::size_t bytes_of(VoxelType type) {
  return with_number(type, [](auto zero) { return sizeof zero; });
}

void read_voxels(ByteSource& source, const VoxelCoding& coding, const std::string& file, Volume& volume) {
  const std::size_t slice =
      static_cast<std::size_t>(volume.grid.size.x()) * static_cast<std::size_t>(volume.grid.size.y());
  source.refuse_if_shorter_than(volume.grid.voxel_count() * bytes_of(coding.type));
  std::vector<std::byte> bytes(slice * bytes_of(coding.type));
  bool rounded = false;
  volume.voxels.clear();
  for (int k = 0; k < volume.grid.size.z(); ++k) {
    source.read(bytes);
    const std::size_t before = volume.voxels.size();
    rounded |= with_number(coding.type,
                           [&](auto zero) { return append<decltype(zero)>(bytes, coding, volume.voxels); });
    refuse_not_finite(volume.voxels, before, file);
  }
  if (rounded) volume.warnings.emplace_back("values above 16777216 are rounded to the precision of a float");
}

void refuse_not_finite(const std::vector<float>& voxels, std::size_t from, const std::string& file) {
  for (std::size_t n = from; n < voxels.size(); ++n)
    if (!std::isfinite(voxels[n]))
      throw ConfigError(
          fmt::format("voxel number {} is not a finite number (NaN, infinite or beyond a float)", n), file,
          "repair the image where it was processed: say what these voxels are");
}

}  // namespace biopsy::imaging
