// What every voxel grid must be before a needle is planned on it, whatever file it came from.
#pragma once

#include <string>

#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

// Directions (unit length) may be off perpendicular by this much: cosines written with four digits reach
// 1e-4, and 2e-4 moves the far end of a 400 mm field by 0.08 mm, less than the robot's 0.1 mm.
inline constexpr double kDirectionTolerance = 2e-4;
inline constexpr double kSpacingMax_mm = 100.0;
inline constexpr double kOriginMax_mm = 10'000.0;  // 10 m from the isocentre there is no patient
inline constexpr int kSizeMin = 3;                 // fewer voxels along an axis are pictures, not a volume
inline constexpr int kSizeMax = 4096;
inline constexpr double kVoxelsMax = 2147483648.0;

// Throws ConfigError naming the file when a size is outside [3, 4096], the product exceeds 2^31, a number is
// not finite, a spacing is outside (0, 100] mm, the origin is more than 10 m away or the axes are not
// perpendicular.
void refuse_bad_size(const Eigen::Vector3i& size, const std::string& file, int slices_min = kSizeMin);
void refuse_bad_grid(const Grid& grid, const std::string& file, int slices_min = kSizeMin);

}  // namespace biopsy::imaging
