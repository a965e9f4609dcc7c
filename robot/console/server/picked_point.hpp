// A point that was clicked on the image. The page sends it twice, as voxel and in millimetres; both must be
// the same position in the series that is planned on.
#pragma once

#include <string>
#include <variant>

#include "robot/msg/console_messages.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::console {

inline constexpr double kMismatchMax_mm = 0.1;

// The position in LPS, computed from the voxel; or why it is refused.
std::variant<Point, std::string> picked_point(const Volume& image, const commands::SetPoint& picked);

// Rows of the map from voxel to R, A, S in mm, as the page gets it.
std::array<double, 16> ras_from_voxel(const Grid& grid);
// Angle between the image's axes and those of the patient that they are nearest to, the largest of three.
double oblique_deg(const Grid& grid);

}  // namespace biopsy::console
