// What the after image would show if nothing but the patient had changed.
#pragma once

#include <vector>

#include "planner/imaging/registration/local_motion.hpp"

namespace biopsy::imaging {

struct Prediction {
  std::vector<VoxelRow> rows;  // of the after image, what is in reach
  // Of each voxel of the rows: value, NaN where the before image does not know; steepness per mm; standard
  // deviation of the value for what lies between the before image's voxels.
  std::vector<float> value, steepness, interpolation;

  bool knows(const Eigen::Vector3i& voxel) const;
};

// The before image, moved, averaged over the after image's voxels and matched in brightness, within `reach`
// of the needle's path.
Prediction predicted(const Volume& before, const Volume& after, const TissueMotion& motion,
                     const NeedleMask& needle, const NeedleMask& reach);

}  // namespace biopsy::imaging
