#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Bouc-Wen spring, normalised: it starts with `stiffness` and yields at a displacement `yield` after the last
// reversal; its inner displacement z stays within +-yield. It is between plate A and the frame, or across the
// series spring, driven by the motion of plate A against plate B.
struct HystereticSpring {
  double stiffness = 0.0;  // N/m
  double yield = 0.5e-3;   // m
  double sharpness = 2.0;  // exponent n: 1 a smooth bend, large a corner
  double beta = 0.5;       // gamma/(gamma + delta): 0.5 unloads with the full stiffness, more with more
  double across = 0.0;     // 0: against the frame, 1: across the series spring

  using State = double;  // m, inner displacement z

  double pull(double z) const { return stiffness * std::clamp(z, -yield, yield); }
  double load(const PlateMotion& a, double z) const { return (a.on_stack ? 1.0 - across : 1.0) * pull(z); }
  double spring_push(const SpringMotion& s, double z) const { return s.on_stack ? -across * pull(z) : 0.0; }
  double bounded(double z) const { return std::clamp(z, -yield, yield); }
  double state_rate(const Flow& f, double z) const { return rate(f.v - across * f.n * f.dH, bounded(z)); }
  Steepness steepest(const Reach&) const { return {.stiffness = stiffness * std::max(1.0, 2.0 * beta)}; }
  double rate(double v, double z) const {
    const double turn = v * z > 0.0 ? beta : v * z < 0.0 ? -beta : 0.0;
    const double share = std::abs(z) / yield;
    const double bend = sharpness == 2.0 ? share * share : std::pow(share, sharpness);  // mostly 2
    return v * (1.0 - bend * (turn + 1.0 - beta));
  }

  static constexpr EffectInfo info{
      "hysteretic_spring",
      Attachment::Stage,
      "A restoring force that depends on the history of the motion: stiff after each reversal, then "
      "yielding.",
      "F = -stiffness z, dz/dt = v (1 - |z/yield|^n (beta sign(v z) + 1 - beta)), v = v_A - across v_B",
      "slow_triangle",
      "Bouc 1967; Wen 1976, ASCE J. Eng. Mech. 102(2); Ikhouane, Rodellar 2007, normalised form"};
  static constexpr auto parameters() {
    using E = HystereticSpring;
    return std::array{
        Parameter<E>{"stiffness_N_per_mm", &E::stiffness, 1e3, 0.0, 1e6, 0.05, "before it yields",
                     Role::Strength},
        Parameter<E>{"yield_mm", &E::yield, 1e-3, 1e-4, 1e4, 0.5, "displacement at which it yields",
                     Role::Shape},
        Parameter<E>{"sharpness", &E::sharpness, 1.0, 1.0, 6.0, 2.0, "exponent n of the bend", Role::Shape},
        Parameter<E>{"beta", &E::beta, 1.0, 0.05, 5.0, 0.5, "how much a reversal stiffens it", Role::Shape},
        Parameter<E>{"across_share", &E::across, 1.0, 0.0, 1.0, 0.0,
                     "0: between plate A and the frame, 1: across the series spring", Role::Shape,
                     kMayBeLeftOut}};
  }
};

}  // namespace biopsy::sim
