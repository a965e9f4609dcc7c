#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// The amplifier's output saturates: linear up to level - knee, a parabola up to level + knee, then constant.
struct VoltageSaturation {
  double level = 1e9;  // V, never exceeded; beyond any voltage the effect is absent
  double knee = 0.0;   // V, half width of the bend; 0 is a hard limit

  double limited(double u) const {
    const double size = std::abs(u), half = std::min(knee, level);
    if (size <= level - half) return u;
    if (size >= level + half) return std::copysign(level, u);
    const double missing = level + half - size;
    return std::copysign(level - missing * missing / (4.0 * half), u);
  }

  static constexpr bool linearises = true;
  static constexpr EffectInfo info{
      "voltage_saturation",
      Attachment::Electrical,
      "Above some voltage the amplifier saturates: a higher command changes nothing.",
      "|u_i| = |u| up to level - knee, level - (level + knee - |u|)^2/(4 knee) within the knee, level beyond",
      "voltage_staircase_up_and_down",
      "Horowitz, Hill 2015, The Art of Electronics, 3rd ed., ch. 4: output swing"};
  static constexpr auto parameters() {
    using E = VoltageSaturation;
    return std::array{Parameter<E>{"level_kV", &E::level, 1e3, 0.05, 100.0, 4.0,
                                   "voltage that is never exceeded", Role::Level},
                      Parameter<E>{"knee_kV", &E::knee, 1e3, 0.0, 20.0, 0.3,
                                   "half width of the bend; 0 is a hard limit", Role::Shape}};
  }
};

}  // namespace biopsy::sim
