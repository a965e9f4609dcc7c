// The three planes of a volume through its middle, as a person expects to see them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "robot/common/picture.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

// Pictures "axial", "coronal" and "sagittal" through the volume's centre, true to scale, in radiological
// convention: the patient's right is on the left, anterior or superior is up.
std::vector<std::pair<std::string, Picture>> orthogonal_slices(const Volume& volume);

}  // namespace biopsy::imaging
