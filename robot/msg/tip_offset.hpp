// How far a needle's signal void goes on beyond its tip: a quantity of the needle and of the sequence that
// images it, calibrated with a needle at a known depth.
#pragma once

#include <string>

#include "robot/common/units.hpp"

namespace biopsy {

// The sequence of images that the built-in scanner renders; no real scanner's calibration may have this name.
inline constexpr const char* kSimulatedSequence = "simulated";

struct TipOffset {
  std::string needle, sequence;
  Millimetres value{0.0};  // positive: the void ends beyond the tip; taken off the depth that is read
  Millimetres sigma{0.2};  // one standard deviation, of the next insertion

  bool operator==(const TipOffset&) const = default;
};

}  // namespace biopsy
