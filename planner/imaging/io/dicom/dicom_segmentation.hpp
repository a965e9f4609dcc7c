// DICOM segmentations (SEG, PS3.3 A.51): bits of each segment in frames, with the place of each frame.
#pragma once

#include <filesystem>
#include <optional>

#include "planner/imaging/io/labels.hpp"

namespace biopsy::imaging {

// The one file of a segmentation that `path` is, or that a folder holds and nothing else of DICOM.
std::optional<std::filesystem::path> dicom_segmentation_at(const std::filesystem::path& path);

// Labels are the segments' numbers; slices without a frame are empty. Throws ConfigError naming file and
// reason: fractional or compressed segments, a frame of no segment, frames of two orientations or sizes or
// off one evenly spaced stack, missing pixels.
LabelMap read_dicom_segmentation(const std::filesystem::path& file);

}  // namespace biopsy::imaging
