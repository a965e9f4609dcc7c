#pragma once

#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Charge trapped in the films screens part of the voltage and follows it over seconds.
struct ChargeRetention {
  double share = 0.0;  // of u_o that is screened in the end
  double time = 5.0;   // s

  Screening screening() const { return {share, time}; }

  static constexpr EffectInfo info{
      "charge_retention",
      Attachment::Electrical,
      "Charge trapped in the films screens part of the voltage, so that a held voltage pulls less and less "
      "and a "
      "reversal pulls more for a while.",
      "d s/dt = (share u_o - s)/time; pressure from u_o - s",
      "dc_hold",
      "Kellaris et al. 2018, Science Robotics 3(14): charge retention in HASEL films; paper III.A"};
  static constexpr auto parameters() {
    using E = ChargeRetention;
    return std::array{
        Parameter<E>{"share", &E::share, 1.0, 0.0, 0.95, 0.2, "of the voltage that is screened in the end",
                     Role::Strength},
        Parameter<E>{"time_s", &E::time, 1.0, 0.01, 1e4, 5.0,
                     "time constant with which the screening follows the voltage", Role::Shape}};
  }
};

}  // namespace biopsy::sim
