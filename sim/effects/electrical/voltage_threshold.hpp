#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Dead zone: the first volts do not pull, and are missing above it as well.
struct VoltageThreshold {
  double threshold = 0.0;  // V

  double acting(double u) const { return std::copysign(std::max(0.0, std::abs(u) - threshold), u); }

  static constexpr bool linearises = true;
  static constexpr EffectInfo info{
      "voltage_threshold",
      Attachment::Electrical,
      "Below some voltage nothing pulls; above it only what exceeds it does.",
      "u_eff = sign(u) max(0, |u| - threshold)",
      "voltage_staircase_up_and_down",
      "Tao, Kokotovic 1996, Adaptive Control of Systems with Actuator and Sensor Nonlinearities: dead zone"};
  static constexpr auto parameters() {
    using E = VoltageThreshold;
    return std::array{Parameter<E>{"threshold_V", &E::threshold, 1.0, 0.0, 1e4, 150.0,
                                   "voltage on the stack that does not pull", Role::Strength}};
  }
};

}  // namespace biopsy::sim
