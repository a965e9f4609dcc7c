// Planes of the body with the target in them, and what changed between two pictures.
#pragma once

#include <string>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

// An SVG that holds the picture: dashed lines through the target with a gap about it, the needle's path, the
// patient's sides, name, coordinate, slice and window. Empty for an empty picture.
std::string plane_overlay(const BodyPlane& plane, bool simulated);

// Two pictures of one size with one window: grey where both are alike, brighter where `after` is brighter.
// Marks that are drawn in colour are left out. Empty where the sizes differ or nothing is there.
Picture difference_of(const Picture& before, const Picture& after);

}  // namespace biopsy::report
