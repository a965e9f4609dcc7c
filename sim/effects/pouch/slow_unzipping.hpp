#pragma once

#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// The rate of zipping depends on its direction: electrostatic pressure closes the films, while only the load
// and the oil open them.
struct SlowUnzipping {
  double share = 0.0;  // of tau_h that the fall takes longer; negative: shorter

  double oil_time_ratio(double gap) const { return gap < 0.0 ? 1.0 + share : 1.0; }

  static constexpr EffectInfo info{
      "slow_unzipping",
      Attachment::Pouch,
      "Pouches open at another rate than they close, so that the stack falls slower (or faster) than it "
      "rises.",
      "dH/dt = (H_eq - H)/tau_h rising, (H_eq - H)/((1 + share) tau_h) falling",
      "frequency_sweep",
      "Rothemund, Kirkman, Keplinger 2020, PNAS 117(28): dynamics of electrohydraulic actuators, limited by "
      "the flow of the oil"};
  static constexpr auto parameters() {
    using E = SlowUnzipping;
    return std::array{Parameter<E>{"share", &E::share, 1.0, -0.8, 100.0, 0.5,
                                   "of tau_h, by which the fall takes longer", Role::Strength}};
  }
};

}  // namespace biopsy::sim
