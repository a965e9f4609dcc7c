#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Play between plate A and what is measured; plate A starts in its middle.
struct Backlash {
  double gap = 0.0;  // m, total width

  struct State {
    double carried = 0.0;  // m, position of what is measured
  };
  double transmitted(const State& own) const { return own.carried; }
  void remember(const Moved& now, State& own) const {
    own.carried = std::clamp(own.carried, now.x - 0.5 * gap, now.x + 0.5 * gap);
  }
  void settle(const SteadyMotion& now, State& own) const {
    own.carried = now.v == 0.0 ? now.x : now.x - std::copysign(0.5 * gap, now.v);
  }
  void shift(double dx, State& own) const { own.carried += dx; }

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
