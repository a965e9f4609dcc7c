#pragma once

#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Slow extra height c of a pouch under load: exponential approach to share (H - H_0), or growth with the
// logarithm of time (c = share (H - H_0) ln(1 + t/time) after a step), or a mixture.
struct PouchCreep {
  double share = 0.0;      // of the pouch's deflection
  double time = 10.0;      // s
  double log_share = 0.0;  // 0 exponential, 1 logarithmic

  using State = double;  // m, c

  double rate(double deflection, double crept) const {
    const double aim = share * deflection;
    const double fading = (1.0 - log_share) * (aim - crept);
    const double lasting = aim > 0.0 ? log_share * aim * std::exp(-crept / aim) : 0.0;
    return (fading + lasting) / time;
  }
  double state_rate(const Flow& f, double crept) const { return rate(f.deflection, crept); }
  PouchOffset pouch_offset(const PouchMotion& p, double crept) const {
    return {.height = crept, .rate = rate(p.deflection, crept)};
  }
  Steepness steepest(const Reach&) const { return {.rate = 1.0 / time}; }

  static constexpr EffectInfo info{
      "pouch_creep",
      Attachment::Pouch,
      "Under load the pouches keep rising slowly, for seconds to minutes.",
      "x_B = n (H - H_0 + c), dc/dt = ((1 - q)(d - c) + q d exp(-c/d))/time, d = share (H - H_0), q = "
      "log_share",
      "dc_hold",
      "Findley, Lai, Onaran 1976, Creep and Relaxation of Nonlinear Viscoelastic Materials, ch. 5"};
  static constexpr auto parameters() {
    using E = PouchCreep;
    return std::array{
        Parameter<E>{"share", &E::share, 1.0, 0.0, 2.0, 0.1, "of the pouch's deflection", Role::Strength},
        Parameter<E>{"time_s", &E::time, 1.0, 0.01, 1e5, 10.0, "time constant", Role::Shape},
        Parameter<E>{"log_share", &E::log_share, 1.0, 0.0, 1.0, 0.0, "0 exponential, 1 logarithmic in time",
                     Role::Shape}};
  }
};

}  // namespace biopsy::sim
