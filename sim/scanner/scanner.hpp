// The confirmation image a scanner would send: the planning volume after the patient moved, with the needle
// in it.
#pragma once

#include <optional>
#include <vector>

#include "robot/msg/volume.hpp"
#include "sim/scanner/needle_artefact.hpp"
#include "sim/scanner/susceptibility/needle_body.hpp"
#include "sim/scanner/susceptibility/sequence.hpp"

namespace biopsy::sim {

// Rigid motion of the tissue: p_after = rotation * (p_before - about) + about + shift. The needle does not
// move with it: the robot holds it in the scanner frame.
struct PatientMotion {
  Point about = Point::Zero();  // usually the entry
  Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_deg = Eigen::Vector3d::Zero();  // rotation vector, LPS axes

  RigidTransform X_after_before() const;
};

struct ScanSettings {
  std::optional<NeedleArtefact> needle;  // painted: a void that ends at the tip;
  std::optional<NeedleBody> body;        // or from first principles (image_with_needle), with this sequence
  Sequence sequence;
  PatientMotion motion;
  std::vector<TissueVoid> voids;  // old tracks and bubbles; at their places before the motion
  double snr = 25.0;              // typical tissue signal over the noise in each channel; 0 or less: no noise
  double drift = 0.1;             // receive sensitivity changes smoothly by up to this fraction at the border
  double ghost = 0.0;  // fraction of the image seen again, displaced along the phase axis (motion, pulsation)
  int ghost_shift_voxels = 0;
  std::uint64_t seed = 1;
  std::optional<Grid> grid;  // of the new image; absent: the planning volume's
};

// Renders the image. Tissue is read with a cubic kernel (Catmull-Rom: the depth check reads linearly, so the
// two do not share an interpolation), tissue outside the planning volume is air; a voxel's void is the mean
// over the voxel, so a thin needle in thick slices is as faint as in life; noise is Rician. Same settings,
// same voxels, on every machine. Throws ConfigError when a grid is empty, a number is not finite, or there
// are two needles.
Volume scan(const Volume& planning, const ScanSettings& settings);

// Typical tissue signal: the median of what is brighter than a tenth of the 99th percentile (the rest is
// air).
double tissue_signal(const Volume& volume);

}  // namespace biopsy::sim
