// |value| of any number, the most negative included.
#pragma once

#include <algorithm>
#include <cstdint>

#include "safety/types/limits.hpp"

namespace biopsy::safety {

constexpr std::int64_t magnitude(std::int32_t value) {
  return value < 0 ? -std::int64_t{value} : value;
}

// Of a drive: no more than the robot may put out.
constexpr std::int32_t drive_magnitude_mV(std::int32_t drive_mV) {
  return static_cast<std::int32_t>(std::min<std::int64_t>(magnitude(drive_mV), limits::kDriveMax_mV));
}

}  // namespace biopsy::safety
