#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Zipping needs more pressure than staying zipped: a play between the height at which pressure carries the
// load and the height that the pouch goes to.
struct ZippingHysteresis {
  double width = 0.0;  // m of height per pouch, full width of the loop
  double free = 0.0;   // share of the height that follows pressure at once

  // The play operator: the zipped height stays where it was while the equilibrium H is within the play.
  double zipped(double H, double before) const {
    return std::clamp(before, H - 0.5 * width, H + 0.5 * width);
  }

  // What the pouch goes to, the zipped height being `held`.
  double height(double H, double held) const { return free * H + (1.0 - free) * held; }

  struct State {
    double H = 0.0;  // m, zipped height
  };
  Equilibrium held(Equilibrium goal, double H_0, const State& own) const {
    constexpr double kEdge = 1e-12;  // m: within it the height stands at the edge of the play
    const double zipped_H = std::max(H_0, zipped(goal.H, own.H));
    const bool inside = std::abs(goal.H - own.H) < 0.5 * width - kEdge;
    return {
        .H = height(goal.H, zipped_H),
        .slope = inside || zipped_H == H_0 ? goal.slope * free : goal.slope};  // the play takes up the load
  }
  void hold(double H, double H_0, State& own) const { own.H = std::max(H_0, zipped(H, own.H)); }
  void settle(const SteadyMotion& now, State& own) const { own.H = std::max(now.H_0, own.H + now.dH); }

  static constexpr EffectInfo info{
      "zipping_hysteresis",
      Attachment::Pouch,
      "A pouch rises later than the voltage and falls later than it, because zipped films adhere to each "
      "other.",
      "H = free H_eq + (1 - free) H_zip, H_zip = clamp(H_zip, H_eq - width/2, H_eq + width/2), never below "
      "H_0",
      "voltage_staircase_up_and_down",
      "Prandtl-Ishlinskii: a play beside a direct part; paper Fig. 8b: loop of about 30 % of the largest "
      "strain"};
  static constexpr auto parameters() {
    using E = ZippingHysteresis;
    return std::array{Parameter<E>{"width_mm", &E::width, 1e-3, 0.0, 5.0, 0.1,
                                   "full width of the loop, height of one pouch", Role::Strength},
                      Parameter<E>{"free_share", &E::free, 1.0, 0.0, 1.0, 0.0,
                                   "share of the height that has no play", Role::Shape, kMayBeLeftOut}};
  }
};

}  // namespace biopsy::sim
