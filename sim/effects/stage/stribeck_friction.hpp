#pragma once

#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Friction that falls from breakaway to sliding with speed; causes stick-slip.
struct StribeckFriction {
  double sliding = 0.0;    // N
  double breakaway = 0.0;  // N
  double speed = 1e-3;     // m/s, where the excess has fallen to 1/e

  double magnitude(double v) const {
    if (v == 0.0) return breakaway;
    const double ratio = v / speed;
    return sliding + (breakaway - sliding) * std::exp(-ratio * ratio);
  }
  double dry_friction(const PlateMotion& a) const { return magnitude(a.v); }

  static constexpr EffectInfo info{"stribeck_friction",
                                   Attachment::Stage,
                                   "Plate A needs a larger force to break away than to keep sliding, so that "
                                   "it sticks and slips at low speed.",
                                   "F = -(sliding + (breakaway - sliding) exp(-(v/speed)^2)) sign(v)",
                                   "slow_triangle",
                                   "Armstrong-Helouvry, Dupont, Canudas de Wit 1994, Automatica 30(7)"};
  static constexpr auto parameters() {
    using E = StribeckFriction;
    return std::array{Parameter<E>{"sliding_N", &E::sliding, 1.0, 0.0, 1e4, 0.03,
                                   "friction while sliding fast", Role::Strength},
                      Parameter<E>{"breakaway_N", &E::breakaway, 1.0, 0.0, 1e4, 0.05,
                                   "friction that must be overcome from rest", Role::Strength},
                      Parameter<E>{"speed_mm_s", &E::speed, 1e-3, 0.001, 1e4, 1.0,
                                   "speed at which the excess has fallen to 1/e", Role::Shape}};
  }
};

}  // namespace biopsy::sim
