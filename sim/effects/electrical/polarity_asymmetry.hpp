#pragma once

#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Different gains for the two polarities.
struct PolarityAsymmetry {
  double share = 0.0;  // signed: positive voltage acts as (1 + share) times itself, negative as (1 - share)

  double acting(double u) const { return u > 0.0 ? u * (1.0 + share) : u * (1.0 - share); }

  static constexpr bool linearises = true;
  static constexpr EffectInfo info{
      "polarity_asymmetry",
      Attachment::Electrical,
      "One polarity pulls more than the other, so that plate A ripples at the frequency of the reversals.",
      "u_eff = u (1 + share sign(u))",
      "closed_loop_steps",
      "Rothemund, Kirkman, Keplinger 2020, PNAS 117(28): polarity reversal against charge in the films"};
  static constexpr auto parameters() {
    using E = PolarityAsymmetry;
    return std::array{Parameter<E>{"share", &E::share, 1.0, -0.9, 0.9, 0.05,
                                   "added to positive, taken from negative voltage", Role::Strength}};
  }
};

}  // namespace biopsy::sim
