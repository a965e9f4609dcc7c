#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// LuGre friction: bristles between plate A and its guide bend elastically before they slip, and slip more
// easily the faster they do. The model's c_s is its viscous part. Without breakaway it is Dahl's friction.
// Between reversals their equation is solved in closed form for the speed of the moment, so that a step need
// not follow how they slip; but plate A on bristles that hold it. Their damping fades with speed as the
// excess does, without which they would give energy.
struct LugreFriction {
  double sliding = 0.0;    // N
  double breakaway = 0.0;  // N; counts where it is above `sliding`
  double speed = 1e-3;     // m/s, where the excess has fallen to 1/e
  double stiffness = 5e3;  // N/m, of the bristles
  double damping = 0.0;    // s, of the bristles, over their stiffness

  double slowness(double v) const { return std::exp(-(v / speed) * (v / speed)); }  // 1 at rest
  // Friction of steady sliding at v. N
  double steady(double v) const { return sliding + std::max(0.0, breakaway - sliding) * slowness(v); }

  struct State {
    double x = 0.0, bend = 0.0;  // m, plate A, and the mean deflection of the bristles there
  };
  // Of the bristles, plate A having moved to x with a speed of about v.
  double bend(double x, double v, const State& own) const {
    const double moved = x - own.x, most = std::copysign(steady(v) / stiffness, moved);
    return most == 0.0 ? 0.0 : most + (own.bend - most) * std::exp(-moved / most);
  }
  double load(const PlateMotion& a, const State& own) const {
    const double g = steady(a.v);
    if (g <= 0.0) return 0.0;
    const double z = bend(a.x, a.v, own);
    return stiffness * (z + damping * slowness(a.v) * (a.v - stiffness * std::abs(a.v) * z / g));
  }
  void remember(const Moved& now, State& own) const {
    own = {now.x, bend(now.x, now.h > 0.0 ? (now.x - own.x) / now.h : 0.0, own)};
  }
  void settle(const SteadyMotion& now, State& own) const {
    own = {now.x, now.v == 0.0 ? own.bend : std::copysign(steady(now.v) / stiffness, now.v)};
  }
  void shift(double dx, State& own) const { own.x += dx; }
  Steepness steepest(const Reach&) const { return {.stiffness = stiffness, .damping = stiffness * damping}; }
  double cut_rate(const Outlook& now) const {  // plate A rings on bristles that hold it
    const double rate = std::sqrt(stiffness / now.mass) + stiffness * damping / now.mass;
    return steady(0.0) > 0.0 ? 2.0 * rate : 0.0;
  }

  static constexpr EffectInfo info{
      "lugre_friction",
      Attachment::Stage,
      "The guide's friction gives way elastically before plate A slides, and is larger at low speed.",
      "F = -stiffness (z + damping s dz/dt), dz/dt = v - stiffness |v| z/g, s = exp(-(v/speed)^2), "
      "g = sliding + (breakaway - sliding) s",
      "slow_triangle",
      "Canudas de Wit et al. 1995, IEEE Trans. Autom. Control 40(3); s of the damping: Olsson et al. 1998, "
      "Eur. J. Control 4(3)"};
  static constexpr auto parameters() {
    using E = LugreFriction;
    return std::array{Parameter<E>{"sliding_N", &E::sliding, 1.0, 0.0, 1e4, 0.03,
                                   "friction while sliding fast", Role::Strength},
                      Parameter<E>{"breakaway_N", &E::breakaway, 1.0, 0.0, 1e4, 0.05,
                                   "friction that must be overcome from rest", Role::Strength},
                      Parameter<E>{"speed_mm_s", &E::speed, 1e-3, 0.001, 1e4, 1.0,
                                   "speed at which the excess has fallen to 1/e", Role::Shape},
                      Parameter<E>{"stiffness_N_per_mm", &E::stiffness, 1e3, 1e-3, 1e4, 0.3,
                                   "of the bristles", Role::Shape},
                      Parameter<E>{"damping_ms", &E::damping, 1e-3, 1e-3, 10.0, 1.0,
                                   "of the bristles, over their stiffness", Role::Shape, kMayBeLeftOut}};
  }
};

}  // namespace biopsy::sim
