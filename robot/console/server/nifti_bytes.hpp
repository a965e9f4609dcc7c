// A volume as one NIfTI-1 file in memory, for the viewer in the page.
#pragma once

#include <string>

#include "robot/msg/volume.hpp"

namespace biopsy::console {

// Voxels as 32-bit floats, the place of the patient as sform in R, A, S.
std::string nifti_bytes(const Volume& volume);

}  // namespace biopsy::console
