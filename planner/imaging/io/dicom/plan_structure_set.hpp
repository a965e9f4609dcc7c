// A plan as a DICOM RT structure set (RTSTRUCT, PS3.3 A.19), for programs that show structures on an image:
// same patient, study and frame of reference as the planning image, which it refers to.
#pragma once

#include <filesystem>

#include "robot/msg/plan.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

// Only an image that is DICOM, with a study and a frame of reference, can be referred to.
bool takes_structure_set(const Volume& image);

// Structures: the points "entry" and "target", the line "needle path" that the tip takes, and a point for the
// end of each step. Patient and study are copied from the image's first file. UIDs follow from plan and
// image: the same plan on the same image is the same file. Throws ConfigError where a file of the image
// cannot be read any more or `file` cannot be written.
void write_plan_structure_set(const Plan& plan, const Volume& image, const std::filesystem::path& file);

}  // namespace biopsy::imaging
