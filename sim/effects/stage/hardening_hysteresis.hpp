#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Bouc-Wen spring whose loop stiffens as it is loaded (gamma + delta < 0), as in wire rope and rubber mounts.
// Its inner displacement z grows faster than plate A moves, without end for an exponent above 1: it is held
// within +-20 `scale`.
struct HardeningHysteresis {
  double stiffness = 0.0;  // N/m, about z = 0
  double scale = 3e-3;     // m of z at which its stiffness has doubled
  double exponent = 1.0;   // n
  double loop = 1.0;       // how much stiffer it unloads than it loads

  using State = double;  // m, inner displacement z

  double load(const PlateMotion&, double z) const { return stiffness * bounded(z); }
  double bounded(double z) const { return std::clamp(z, -kMost * scale, kMost * scale); }
  double state_rate(const Flow& f, double z) const { return rate(f.v, bounded(z)); }
  Steepness steepest(const Reach& reach) const {
    const double share = std::min(kMost, std::expm1(std::min(std::abs(reach.x) / scale, kMost)));
    return {.stiffness = stiffness * (1.0 + grown(share) * (1.0 + 2.0 * loop))};
  }
  double grown(double share) const { return exponent == 1.0 ? share : std::pow(share, exponent); }
  double rate(double v, double z) const {
    const double turn = v * z > 0.0 ? 1.0 : v * z < 0.0 ? -1.0 : 0.0;
    return v * (1.0 + grown(std::abs(z) / scale) * (1.0 + loop * (1.0 - turn)));
  }

  static constexpr double kMost = 20.0;  // |z| in scales

  static constexpr EffectInfo info{
      "hardening_hysteresis",
      Attachment::Stage,
      "A restoring force that depends on the history of the motion and stiffens as it is loaded.",
      "F = -stiffness z, dz/dt = v (1 + |z/scale|^n (1 + loop (1 - sign(v z))))",
      "slow_triangle",
      "Bouc 1967; Wen 1976, ASCE J. Eng. Mech. 102(2); gamma + delta < 0: Noel, Schoukens 2016, hysteretic "
      "benchmark"};
  static constexpr auto parameters() {
    using E = HardeningHysteresis;
    return std::array{
        Parameter<E>{"stiffness_N_per_mm", &E::stiffness, 1e3, 0.0, 1e6, 0.05, "about the middle",
                     Role::Strength},
        Parameter<E>{"scale_mm", &E::scale, 1e-3, 1e-4, 1e4, 3.0,
                     "inner displacement at which the stiffness has doubled", Role::Shape},
        Parameter<E>{"exponent", &E::exponent, 1.0, 1.0, 3.0, 1.0, "how the stiffness grows", Role::Shape},
        Parameter<E>{"loop", &E::loop, 1.0, 0.0, 10.0, 1.0, "how much stiffer it unloads than it loads",
                     Role::Shape}};
  }
};

}  // namespace biopsy::sim
