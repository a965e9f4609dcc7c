#pragma once

#include <algorithm>
#include <array>

#include "sim/plant/effect.hpp"

namespace biopsy::sim {

// An upper stop: beyond its position a stiff contact pushes plate A back; it never pulls.
struct EndStop {
  double position = 1e3;   // m
  double stiffness = 0.0;  // N/m
  double damping = 0.0;    // N s/m, while in contact

  double push_back(double x, double v) const {
    return x > position ? std::max(0.0, stiffness * (x - position) + damping * v) : 0.0;
  }

  static constexpr EffectInfo info{"end_stop",
                                   Attachment::Stage,
                                   "Beyond some position plate A runs against something stiff.",
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
