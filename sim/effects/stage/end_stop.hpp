#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Upper stop: beyond its position a stiff contact pushes plate A back and never pulls.
struct EndStop {
  double position = 1e3;   // m
  double stiffness = 0.0;  // N/m
  double damping = 0.0;    // N s/m, while in contact

  double load(const PlateMotion& a) const {
    return a.x > position ? std::max(0.0, stiffness * (a.x - position) + damping * a.v) : 0.0;
  }
  Steepness steepest(const Reach&) const { return {.stiffness = stiffness, .damping = damping}; }

  // Five steps in the time in which the contact rings by one radian, one once the ringing is below 0.5 um.
  double cut_rate(const Outlook& now) const {
    if (now.x + 2.0 * std::abs(now.v) * now.h <= position) return 0.0;
    const double ringing = std::sqrt(stiffness / now.mass) + damping / now.mass;  // rad/s
    const bool at_rest_in_it = now.x > position && std::abs(now.v) < 0.5e-6 * ringing;
    return std::max((at_rest_in_it ? 1.0 : 4.0) / now.h, (at_rest_in_it ? 1.0 : 5.0) * ringing);
  }

  static constexpr bool acts_by_position = true;
  static constexpr bool linearises = true;
  static constexpr EffectInfo info{"end_stop",
                                   Attachment::Stage,
                                   "Beyond some position plate A meets a stiff stop.",
                                   "F = -max(0, stiffness (x - position) + damping v) for x > position",
                                   "voltage_staircase_up_and_down",
                                   "Johnson 1985, Contact Mechanics, ch. 11: Kelvin-Voigt contact"};
  static constexpr auto parameters() {
    using E = EndStop;
    return std::array{
        Parameter<E>{"position_mm", &E::position, 1e-3, -1e4, 1e4, 3.0, "where contact begins", Role::Place},
        Parameter<E>{"stiffness_N_per_mm", &E::stiffness, 1e3, 0.0, 1e6, 20.0, "of the contact",
                     Role::Strength},
        Parameter<E>{"damping_N_s_per_m", &E::damping, 1.0, 0.0, 1e6, 2.0, "of the contact", Role::Strength}};
  }
};

}  // namespace biopsy::sim
