#pragma once

#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Pressure that grows with less (or more) than the square of the voltage, being that of eq. (21) at 1 kV: of
// films whose permittivity falls with the field, or whose zipped area grows with it.
struct VoltagePower {
  double deficit = 0.0;  // of the exponent 2

  static constexpr double kSame = 1e3;  // V

  double acting(double u) const { return u == 0.0 ? 0.0 : u * std::pow(std::abs(u) / kSame, -0.5 * deficit); }
  double voltage_for(double acting) const {  // the positive one that acts so
    return kSame * std::pow(acting / kSame, 1.0 / (1.0 - 0.5 * deficit));
  }

  static constexpr bool linearises = true;
  static constexpr EffectInfo info{
      "voltage_power",
      Attachment::Electrical,
      "The films' pressure grows with another power of the voltage than its square.",
      "u_eff = u (|u|/1 kV)^(-deficit/2), so that P grows with |u|^(2 - deficit)",
      "voltage_staircase_up_and_down",
      "Tagantsev et al. 2003, J. Electroceram. 11: permittivity that falls with the field; Kellaris et al. "
      "2019, Extreme Mech. Lett. 29"};
  static constexpr auto parameters() {
    using E = VoltagePower;
    return std::array{
        Parameter<E>{"deficit", &E::deficit, 1.0, -1.0, 1.5, 0.1, "of the exponent below 2", Role::Strength}};
  }
};

}  // namespace biopsy::sim
