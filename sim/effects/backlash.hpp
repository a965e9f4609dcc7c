#pragma once

#include <algorithm>
#include <array>

#include "sim/plant/effect.hpp"

namespace biopsy::sim {

// Free play between plate A and what is measured: at the start plate A stands in its middle.
struct Backlash {
  double gap = 0.0;  // m, total width

  double carried(double x, double before) const { return std::clamp(before, x - 0.5 * gap, x + 0.5 * gap); }

  static constexpr EffectInfo info{
      "backlash",
      Attachment::Stage,
      "After each reversal plate A first crosses a free play before what is "
      "measured moves with it.",
      "x_m = clamp(x_m, x_A - gap/2, x_A + gap/2)",
      "slow_triangle",
      "Nordin, Gutman 2002, Automatica 38(10): controlling systems with backlash"};
  static constexpr auto parameters() {
    using E = Backlash;
    return std::array{
        Parameter<E>{"gap_mm", &E::gap, 1e-3, 0.0, 1e3, 0.1, "total width of the play", Role::Strength}};
  }
};

}  // namespace biopsy::sim
