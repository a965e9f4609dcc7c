// Directions in the patient as the letters people read on images: R L, A P, S I.
#pragma once

#include <string>

#include "robot/common/frames.hpp"

namespace biopsy::robot {

// The strongest letter first, and each other that has at least a quarter of it: "A" straight ahead, "AR"
// oblique.
std::string anatomical_directions(const Direction& lps);

// The same with numbers, for a table: "R 0.98, A 0.17".
std::string side_shares(const Direction& lps);

}  // namespace biopsy::robot
