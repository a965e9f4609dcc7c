#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Zipped films adhere: part of the voltage goes into separating or joining them, against the pouch's motion.
// Bouc-Wen in the height of the pouch, z within +-1: +1 while it rises, -1 while it falls.
struct FilmHysteresis {
  double loss = 0.0;         // V, half the width of the loop
  double presliding = 2e-5;  // m of height per pouch over which a reversal builds up

  using State = double;  // z

  double pulling(double u, double z) const { return std::max(0.0, std::abs(u) - loss * bounded(z)); }
  double bounded(double z) const { return std::clamp(z, -1.0, 1.0); }
  double state_rate(const Flow& f, double z) const {
    const double held = bounded(z);
    const double bend = f.dH * held > 0.0 ? held * held : 0.0;  // a reversal unloads with the full stiffness
    return f.dH / presliding * (1.0 - bend);
  }
  void settle(const SteadyMotion& now, State& own) const { own = bounded(own + now.dH / presliding); }

  static constexpr EffectInfo info{
      "film_hysteresis",
      Attachment::Pouch,
      "Zipped films adhere to each other, so that part of the voltage is lost while a pouch rises and is "
      "gained while it falls.",
      "u_eff = max(0, |u| - loss z), dz/dt = dH/dt / presliding (1 - z^2 [z dH/dt > 0])",
      "voltage_staircase_up_and_down",
      "Bouc 1967; Wen 1976; paper Fig. 8b: a loop of about 30 % of the largest strain at every load"};
  static constexpr auto parameters() {
    using E = FilmHysteresis;
    return std::array{Parameter<E>{"loss_V", &E::loss, 1.0, 0.0, 3000.0, 300.0, "half the width of the loop",
                                   Role::Strength},
                      Parameter<E>{"presliding_mm", &E::presliding, 1e-3, 1e-4, 1.0, 0.02,
                                   "height of a pouch over which a reversal builds up", Role::Shape}};
  }
};

}  // namespace biopsy::sim
