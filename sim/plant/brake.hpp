// The brake of a stage: clamps plate A to the frame, so that the needle stays without voltage. None in the
// paper; one kind that may stand in a scanner presses two films together by kilovolts and lets go without
// them (Diller et al. 2016: electroadhesive clutches, tens of newtons, milliseconds).
#pragma once

#include <algorithm>

namespace biopsy::sim {

struct Brake {
  double holding_N = 0.0;  // slips beyond
  double stiffness = 0.0;  // N/m, of the clamped parts
  double damping = 0.0;    // N s/m
  double engage_s = 0.0;   // from the command until it grips
  double release_s = 0.0;  // until it has let go

  bool operator==(const Brake&) const = default;
};

// What a brake that grips does to plate A; without stiffness: nothing.
struct Grip {
  double stiffness = 0.0, damping = 0.0, holding_N = 0.0;
  double at = 0.0;  // m, where plate A stands without load

  // Towards rest: what x (m) and v (m/s) are pulled back with. N, down
  double load(double x, double v) const {
    return std::clamp(stiffness * (x - at) + damping * v, -holding_N, holding_N);
  }
  // Drags the clamped place along where it slips.
  void follow(double x) {
    if (stiffness <= 0.0) return;
    const double most = holding_N / stiffness;
    at = std::clamp(at, x - most, x + most);
  }
};

}  // namespace biopsy::sim
