// Finds how the patient moved between two images: rotation and shift in space.
#pragma once

#include <optional>
#include <span>

#include "planner/imaging/registration/needle_mask.hpp"
#include "planner/imaging/registration/region.hpp"
#include "planner/imaging/registration/reslice.hpp"

namespace biopsy::imaging {

struct RegistrationSettings {
  Box box;                         // where to compare, scanner mm
  Point about = Point::Zero();     // centre of rotation: the entry
  std::optional<NeedleMask> mask;  // not asked: a void is no motion
  double shift_max_mm = 12.0;      // a patient who moved further must be planned anew
  double rotation_max_deg = 12.0;
  double start_reach_mm =
      8.0;  // starts on a lattice this far out: the coarse cost is convex over about half of it
};

struct RegistrationResult {
  RigidTransform X_after_before = RigidTransform::Identity();
  Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();      // p_after = R (p_before - about) + about + shift
  Eigen::Vector3d rotation_deg = Eigen::Vector3d::Zero();  // rotation vector, LPS axes
  // Correlation after registration at the finest level: of local contrast, which other tissue does not share;
  // of the images themselves where they are slabs or planes.
  double score = 0.0;
  double runner_up_mm =
      0.0;  // mean distance in the box to the best result from elsewhere that scores nearly alike
  std::size_t points = 0;  // compared; 0 where the images do not overlap
  bool within_limits = false;
  // Brightness: after = gain . (1, x) before + bias . (1, x), x in box half-sides from its centre.
  Eigen::Vector4d gain = Eigen::Vector4d::Zero(), bias = Eigen::Vector4d::Zero();
};

// Six degrees of freedom by robust Gauss-Newton on squared differences with a linearly varying gain and bias,
// from coarse to fine, from the best of a lattice of starts; of volumes, on their local contrast. What images
// do not tell is held near no motion. In space rather than ECC in the needle's plane: patients turn out of
// any plane, and slices of 3 mm give a plane too little of what it needs. `after` may be several stacks that
// were taken together (slabs of a few slices, orthogonal planes): one motion explains them all.
RegistrationResult register_rigid(const Volume& before, std::span<const Volume> after,
                                  const RegistrationSettings& settings);
inline RegistrationResult register_rigid(const Volume& before, const Volume& after,
                                         const RegistrationSettings& settings) {
  return register_rigid(before, std::span(&after, 1), settings);
}

}  // namespace biopsy::imaging
