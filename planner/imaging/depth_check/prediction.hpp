// What the after image would show if nothing but the patient had changed.
#pragma once

#include "planner/imaging/registration/local_motion.hpp"

namespace biopsy::imaging {

// On the after image's grid; NaN where the before image does not know, and out of reach.
struct Prediction {
  Volume value, steepness;  // steepness per mm
  Volume interpolation;     // standard deviation of the value for what lies between the before image's voxels
};

// The before image, moved, averaged over the after image's voxels and matched in brightness, within `reach`
// of the needle's path.
Prediction predicted(const Volume& before, const Volume& after, const TissueMotion& motion,
                     const NeedleMask& needle, const NeedleMask& reach);

}  // namespace biopsy::imaging
