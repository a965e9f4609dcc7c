#pragma once

#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Cubic term of the series spring (of the spring to the frame where a force drives).
struct SpringHardening {
  double cubic = 0.0;  // N/m^3; negative softens

  double force(double stretch) const { return cubic * stretch * stretch * stretch; }
  double spring_push(const SpringMotion& s) const { return force(s.stretch); }
  Steepness steepest(const Reach& r) const { return {.stiffness = std::abs(3.0 * cubic * r.x * r.x)}; }

  static constexpr bool acts_by_position = true;
  static constexpr bool linearises = true;
  static constexpr EffectInfo info{"spring_hardening",
                                   Attachment::Stage,
                                   "The spring stiffens (or softens) with its deformation.",
                                   "F_s += cubic (x_B - x_A)^3; with drive = force: F = -cubic x^3",
                                   "weight_drop",
                                   "Duffing 1918, Erzwungene Schwingungen bei veraenderlicher Eigenfrequenz"};
  static constexpr auto parameters() {
    using E = SpringHardening;
    return std::array{Parameter<E>{"cubic_N_per_mm3", &E::cubic, 1e9, -1e6, 1e6, 1.0,
                                   "force at 1 mm beyond the linear one", Role::Strength}};
  }
};

}  // namespace biopsy::sim
