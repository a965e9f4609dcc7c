// The needle's position as measured in an image, independently of the laser.
#pragma once

#include <optional>
#include <string>

#include "robot/common/units.hpp"

namespace biopsy {

enum class DepthVerdict : std::uint8_t {
  Unsure,  // the image is not conclusive
  Accept,  // needle found where it was expected (or, without an expected depth, found with confidence)
  Reject,  // no needle, or needle elsewhere
};

struct DepthCheck {
  DepthVerdict verdict = DepthVerdict::Unsure;
  std::string reason;  // for display
  bool tip_found = false;
  Millimetres depth;  // tip from the entry along the planned axis; without a calibration the void's end
  Millimetres sigma;  // one standard deviation, the calibration's included
  double lateral_mm = 0.0, lateral_sigma_mm = 0.0;  // distance of the tip from the planned axis
  double angle_deg = 0.0, angle_sigma_deg = 0.0;    // between needle and planned axis
  // How far the void goes on beyond the tip, as calibrated for needle and sequence; taken off the depth.
  bool tip_offset_known = false;
  double tip_offset_mm = 0.0, tip_offset_sigma_mm = 0.0;
  // Patient motion from before to after: p_after = rotation * (p_before - entry) + entry + shift (LPS mm).
  double shift_mm[3] = {0, 0, 0};
  double rotation_deg[3] = {0, 0, 0};            // rotation vector, LPS axes
  std::optional<double> patient_motion_mm = {};  // of entry or planned tip, the larger; none: not known
  double registration_score = 0.0;               // correlation after registration, 1 = identical
  double contrast_to_noise = 0.0;                // of the change along the path
};

}  // namespace biopsy
