#pragma once

#include <algorithm>
#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Friction and drag along the shaft, in proportion to the length inside the tissue.
struct ShaftFriction {
  double from = 0.0;     // m, where this tissue begins
  double to = 1e9;       // m, where it ends
  double coulomb = 0.0;  // N per m inserted
  double viscous = 0.0;  // N s/m per m inserted

  double inserted(double x) const { return std::clamp(x, from, to) - from; }
  double load(const PlateMotion& a) const { return viscous * inserted(a.x) * a.v; }
  double dry_friction(const PlateMotion& a) const { return coulomb * inserted(a.x); }
  Steepness steepest(const Reach& reach) const { return {.damping = viscous * inserted(reach.x)}; }

  static constexpr bool acts_by_position = true;
  static constexpr EffectInfo info{
      "shaft_friction",
      Attachment::Tissue,
      "Tissue rubs on the needle's shaft: friction and drag grow with the inserted length.",
      "F = -(coulomb sign(v) + viscous v) length inserted",
      "slow_triangle",
      "Okamura, Simone, O'Leary 2004, IEEE TBME 51(10), modified Karnopp model"};
  static constexpr auto parameters() {
    using E = ShaftFriction;
    return std::array{
        Parameter<E>{"from_mm", &E::from, 1e-3, -1e4, 1e4, 0.0, "where the tissue begins", Role::Place},
        Parameter<E>{"coulomb_N_per_mm", &E::coulomb, 1e3, 0.0, 1e3, 0.02, "dry friction per inserted length",
                     Role::Strength},
        Parameter<E>{"viscous_N_s_per_m_per_mm", &E::viscous, 1e3, 0.0, 1e4, 0.1,
                     "viscous drag per inserted length", Role::Strength}};
  }
};

}  // namespace biopsy::sim
