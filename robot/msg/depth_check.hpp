// The needle's depth as measured in an image, independently of the laser.
#pragma once

#include <string>

#include "robot/common/units.hpp"

namespace biopsy {

enum class DepthVerdict : std::uint8_t {
  Unsure,  // the image is not conclusive
  Accept,  // tip found where it was expected (or, without an expectation, found with confidence)
  Reject,  // no needle, or tip elsewhere
};

struct DepthCheck {
  DepthVerdict verdict = DepthVerdict::Unsure;
  std::string reason;  // for display
  bool tip_found = false;
  Millimetres depth;  // tip from the entry along the needle axis
  Millimetres sigma;  // one standard deviation
  // Patient motion from before to after: p_after = rotation * (p_before - entry) + entry + shift (LPS mm).
  double shift_mm[3] = {0, 0, 0};
  double rotation_deg[3] = {0, 0, 0};  // rotation vector, LPS axes
  double registration_score = 0.0;     // correlation after registration, 1 = identical
  double contrast_to_noise = 0.0;      // of the change along the path
};

}  // namespace biopsy
