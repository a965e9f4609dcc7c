// What the image says about the needle's depth; it never saw the laser.
#pragma once

#include <string>

#include "robot/common/units.hpp"

namespace biopsy {

enum class DepthVerdict : std::uint8_t {
  Unsure,  // the default: the image does not settle it
  Accept,  // tip found, where it was expected (or, with no expectation, found with confidence)
  Reject,  // the image shows that it is not so: no needle, or tip elsewhere
};

struct DepthCheck {
  DepthVerdict verdict = DepthVerdict::Unsure;
  std::string reason;  // a sentence for a person
  bool tip_found = false;
  Millimetres depth;  // tip along the needle axis from the entry
  Millimetres sigma;  // one standard deviation
  // Patient motion from before to after: p_after = rotation * (p_before - entry) + entry + shift (LPS mm).
  double shift_mm[3] = {0, 0, 0};
  double rotation_deg[3] = {0, 0, 0};  // rotation vector, LPS axes
  double registration_score = 0.0;     // correlation after registration, 1 = identical
  double contrast_to_noise = 0.0;      // of the change along the path
};

}  // namespace biopsy
