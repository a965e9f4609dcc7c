#pragma once

#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Even term of the series spring (of the spring to the frame where a force drives): it is stiffer in one
// direction. With the cubic term of spring_hardening, a polynomial stiffness.
struct AsymmetricSpring {
  double quadratic = 0.0;  // N/m^2; negative: softer in compression

  double spring_push(const SpringMotion& s) const { return quadratic * s.stretch * s.stretch; }
  Steepness steepest(const Reach& r) const { return {.stiffness = std::abs(2.0 * quadratic * r.x)}; }

  static constexpr bool acts_by_position = true;
  static constexpr bool linearises = true;
  static constexpr EffectInfo info{"asymmetric_spring",
                                   Attachment::Stage,
                                   "The spring is stiffer in one direction than in the other.",
                                   "F_s += quadratic (x_B - x_A)^2; with drive = force: F = quadratic x^2",
                                   "weight_drop",
                                   "Nayfeh, Mook 1979, Nonlinear Oscillations, ch. 2: quadratic and cubic "
                                   "terms of a restoring force"};
  static constexpr auto parameters() {
    using E = AsymmetricSpring;
    return std::array{Parameter<E>{"quadratic_N_per_mm2", &E::quadratic, 1e6, -1e4, 1e4, -0.05,
                                   "force at 1 mm beyond the linear one", Role::Strength}};
  }
};

}  // namespace biopsy::sim
