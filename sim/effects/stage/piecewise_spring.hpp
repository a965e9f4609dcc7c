#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Piecewise linear stiffness of the series spring (of the spring to the frame where a force drives): another
// stiffness beyond some deformation, as of coils that touch or of a second spring that is reached.
struct PiecewiseSpring {
  double change = 0.0;  // N/m, of the stiffness; negative softens
  double place = 0.0;   // m, deformation in either direction

  double spring_push(const SpringMotion& s) const {
    return change * std::copysign(std::max(0.0, std::abs(s.stretch) - place), s.stretch);
  }
  Steepness steepest(const Reach&) const { return {.stiffness = std::abs(change)}; }

  static constexpr bool acts_by_position = true;
  static constexpr EffectInfo info{
      "piecewise_spring",
      Attachment::Stage,
      "Beyond some deformation the spring has another stiffness.",
      "F_s += change (|d| - place) sign(d) for |d| > place, d = x_B - x_A; with drive = force: d = -x",
      "weight_drop",
      "Shaw, Holmes 1983, J. Sound Vib. 90(1): a periodically forced piecewise linear oscillator"};
  static constexpr auto parameters() {
    using E = PiecewiseSpring;
    return std::array{
        Parameter<E>{"change_N_per_mm", &E::change, 1e3, -1e4, 1e4, 0.2, "of the stiffness", Role::Strength},
        Parameter<E>{"place_mm", &E::place, 1e-3, 0.0, 1e4, 0.05,
                     "deformation in either direction beyond which it holds", Role::Place}};
  }
};

}  // namespace biopsy::sim
