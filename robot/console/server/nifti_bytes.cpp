#include "robot/console/server/nifti_bytes.hpp"

#include <array>
#include <bit>
#include <cstring>

#include "robot/console/server/picked_point.hpp"

namespace biopsy::console {
namespace {

static_assert(std::endian::native == std::endian::little, "NIfTI is written as it lies in memory");

constexpr std::size_t kHeader = 348, kVoxels = 352;
constexpr std::int16_t kFloat32 = 16, kScannerFrame = 1;
constexpr char kMillimetres = 2;

// Byte offsets of nifti1.h.
template <class Value>
void put(std::string& bytes, std::size_t offset, Value value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

}  // namespace

std::string nifti_bytes(const Volume& volume) {
  std::string bytes(kVoxels, '\0');
  put(bytes, 0, static_cast<std::int32_t>(kHeader));
  put(bytes, 40, std::int16_t{3});
  for (std::size_t axis = 0; axis < 7; ++axis)
    put(bytes, 42 + 2 * axis,
        axis < 3 ? static_cast<std::int16_t>(volume.grid.size[static_cast<int>(axis)]) : std::int16_t{1});
  put(bytes, 70, kFloat32);
  put(bytes, 72, std::int16_t{32});
  put(bytes, 76, 1.0f);
  for (std::size_t axis = 0; axis < 3; ++axis)
    put(bytes, 80 + 4 * axis, static_cast<float>(volume.grid.spacing_mm()[static_cast<int>(axis)]));
  put(bytes, 108, static_cast<float>(kVoxels));
  put(bytes, 112, 1.0f);
  bytes[123] = kMillimetres;
  put(bytes, 254, kScannerFrame);
  const std::array<double, 16> rows = ras_from_voxel(volume.grid);
  for (std::size_t n = 0; n < 12; ++n) put(bytes, 280 + 4 * n, static_cast<float>(rows[n]));
  std::memcpy(bytes.data() + 344, "n+1", 4);
  bytes.append(reinterpret_cast<const char*>(volume.voxels.data()), volume.voxels.size() * sizeof(float));
  return bytes;
}

}  // namespace biopsy::console
