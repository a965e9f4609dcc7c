// Segmentations as 3D Slicer writes them (.seg.nrrd): NRRD with keys that say which number is which segment,
// in one volume or, where segments overlap, in several layers.
#pragma once

#include <filesystem>

#include "planner/imaging/io/labels.hpp"

namespace biopsy::imaging {

// By its keys, whatever its name. False for what is no NRRD file.
bool is_nrrd_segmentation(const std::filesystem::path& file);

// In one volume labels are the numbers in it; of layers, segment N (Segment0_Name is of 0) has label N + 1.
// Throws ConfigError naming file and reason: as read_nrrd_header_fields does; another representation than a
// binary labelmap, two segments with one number in one layer, a number of no segment among layers.
LabelMap read_nrrd_segmentation(const std::filesystem::path& file);

}  // namespace biopsy::imaging
