// Whether a volume is a label map.
#pragma once

#include <string>

#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

// Throws ConfigError naming `where` for a volume that is no label map: values that are negative or no whole
// numbers, more than kLabelsMax of them, or too few neighbours with the same value. A segmentation is made of
// regions, so of its labelled voxels most have their neighbours' label; in a picture with noise few have.
inline constexpr std::size_t kLabelsMax = 1000;
inline constexpr double kLeastSameNeighbours = 0.6;
void refuse_unlike_labels(const Volume& volume, const std::string& where);

}  // namespace biopsy::imaging
