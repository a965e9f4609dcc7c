#pragma once

#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Damping that differs by direction, as of a fluid behind a check valve: more than c_s in one of them.
struct DirectionalDamping {
  double more = 0.0;  // N s/m, while plate A rises; negative: so much more while it falls

  double load(const PlateMotion& a) const { return a.v * more > 0.0 ? std::abs(more) * a.v : 0.0; }
  Steepness steepest(const Reach&) const { return {.damping = std::abs(more)}; }

  static constexpr EffectInfo info{
      "directional_damping",
      Attachment::Stage,
      "Motion in one direction is damped more than in the other.",
      "F = -|more| v for v more > 0, on top of c_s v",
      "weight_drop",
      "Dixon 2007, The Shock Absorber Handbook, 2nd ed.: damping in compression and in extension"};
  static constexpr auto parameters() {
    using E = DirectionalDamping;
    return std::array{Parameter<E>{"more_N_s_per_m", &E::more, 1.0, -1e6, 1e6, 0.5,
                                   "while plate A rises; negative: while it falls", Role::Strength}};
  }
};

}  // namespace biopsy::sim
