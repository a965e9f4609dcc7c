// What keeps a simulated image from being taken for one of a patient.
#pragma once

#include "robot/msg/volume.hpp"

namespace biopsy::sim {

// Gives the image a study, a series and a frame of reference of its own (the same for all simulated images of
// one planning series), the patient's name SIMULATED^..., an id that begins with SIMULATED-, and burns the
// letters SIM into the first rows of each slice that has room for them, 11 x 5 voxels, as bright as the
// brightest voxel.
void mark_simulated(Volume& image);

}  // namespace biopsy::sim
