#pragma once

#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Constant force against the motion of plate A; at rest it balances any smaller force.
struct CoulombFriction {
  double force = 0.0;  // N

  double dry_friction(const PlateMotion&) const { return force; }

  static constexpr EffectInfo info{"coulomb_friction",
                                   Attachment::Stage,
                                   "Dry friction of the guide opposes the motion of plate A with a constant "
                                   "force; the plate sticks at reversals.",
                                   "F = -force sign(v); at v = 0 it balances any net force up to `force`",
                                   "slow_triangle",
                                   "Coulomb 1785; paper IV.D: stick-slip from nonlinear friction"};
  static constexpr auto parameters() {
    return std::array{Parameter<CoulombFriction>{"force_N", &CoulombFriction::force, 1.0, 0.0, 1e4, 0.05,
                                                 "friction of the guide, either direction", Role::Strength}};
  }
};

}  // namespace biopsy::sim
