#pragma once

#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Drag that grows with the square of the speed: a fluid pushed aside or through a gap.
struct QuadraticDamping {
  double coefficient = 0.0;  // N s^2/m^2

  double load(const PlateMotion& a) const { return coefficient * a.v * std::abs(a.v); }
  Steepness steepest(const Reach& reach) const { return {.damping = 2.0 * coefficient * reach.v}; }

  static constexpr bool linearises = true;
  static constexpr EffectInfo info{"quadratic_damping",
                                   Attachment::Stage,
                                   "Fast motion of plate A is damped more than in proportion to its speed.",
                                   "F = -coefficient v |v|",
                                   "weight_drop",
                                   "Batchelor 1967, An Introduction to Fluid Dynamics, ch. 5: drag at high "
                                   "Reynolds number"};
  static constexpr auto parameters() {
    using E = QuadraticDamping;
    return std::array{Parameter<E>{"coefficient_N_s2_per_m2", &E::coefficient, 1.0, 0.0, 1e8, 100.0,
                                   "drag at 1 m/s", Role::Strength}};
  }
};

}  // namespace biopsy::sim
