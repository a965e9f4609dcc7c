#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// The amplifier follows its command as a first-order lag whose slope is limited.
struct AmplifierLag {
  double time = 0.0;  // s
  double slew = 0.0;  // s/V, the least time a volt takes; 0 is unlimited

  AmplifierDynamics amplifier() const { return {time, slew}; }

  // Until the output has come within a thousandth of the command.
  double cut_rate(const Outlook& now) const {
    const double missing = std::abs(now.u_command - now.u_i);
    const bool arrived = missing <= 1e-3 * std::max(std::abs(now.u_command), std::abs(now.u_i));
    return amplifier().instant() || arrived ? 0.0 : 16.0 / (time + missing * slew);
  }

  static constexpr bool linearises = true;
  static constexpr EffectInfo info{"amplifier_lag",
                                   Attachment::Electrical,
                                   "The amplifier's output lags behind its command and cannot change faster "
                                   "than its current limit allows.",
                                   "d u_i/dt = (u - u_i)/time, and |d u_i/dt| <= 1/slew",
                                   "frequency_sweep",
                                   "Horowitz, Hill 2015, The Art of Electronics, 3rd ed., ch. 4: slew rate "
                                   "into a capacitive load"};
  static constexpr auto parameters() {
    using E = AmplifierLag;
    return std::array{
        Parameter<E>{"time_ms", &E::time, 1e-3, 0.0, 1000.0, 1.0, "time constant", Role::Strength},
        Parameter<E>{"slew_ms_per_kV", &E::slew, 1e-6, 0.0, 1000.0, 0.2,
                     "least time that a kilovolt takes; 0 is unlimited", Role::Strength}};
  }
};

}  // namespace biopsy::sim
