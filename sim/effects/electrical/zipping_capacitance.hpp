#pragma once

#include <algorithm>
#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// The films' capacitance C2 grows as they zip, so that the stack takes a smaller share of the amplifier's
// voltage the higher it stands, and loses it more slowly.
struct ZippingCapacitance {
  double growth = 0.0;  // 1/m of height per pouch, of C1 + C2

  double capacitance_ratio(double deflection) const { return 1.0 + growth * std::max(0.0, deflection); }

  static constexpr EffectInfo info{
      "zipping_capacitance",
      Attachment::Electrical,
      "The films' capacitance grows as they zip, so that a stack that stands higher takes a smaller share of "
      "the amplifier's voltage.",
      "C1 + C2 = (C1 + C2)_0 r, r = 1 + growth (H - H_0); K = C1/(C1 + C2), tau = R (C1 + C2); the charge on "
      "C2 stays where H changes",
      "voltage_staircase_up_and_down",
      "paper eq. (2) with C2 of the zipped area; Kellaris et al. 2019, Extreme Mech. Lett. 29: capacitance "
      "of "
      "a zipping pouch"};
  static constexpr auto parameters() {
    return std::array{Parameter<ZippingCapacitance>{"growth_per_mm", &ZippingCapacitance::growth, 1e3, 0.0,
                                                    20.0, 0.3, "of C1 + C2, per height of one pouch",
                                                    Role::Strength}};
  }
};

}  // namespace biopsy::sim
