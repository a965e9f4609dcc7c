#pragma once

#include <algorithm>
#include <array>

#include "sim/plant/effect.hpp"

namespace biopsy::sim {

// Zipping needs more pressure than staying zipped: a play between the height that pressure asks for and the
// height that the pouch goes to.
struct ZippingHysteresis {
  double width = 0.0;  // m of height per pouch, full width of the loop
  double free = 0.0;   // share of the height that follows pressure at once

  // The play operator: the zipped height stays where it was while pressure asks for anything within the play.
  double zipped(double asked, double before) const {
    return std::clamp(before, asked - 0.5 * width, asked + 0.5 * width);
  }

  // What the pouch goes to, the play standing at `held`.
  double height(double asked, double held) const { return free * asked + (1.0 - free) * held; }

  static constexpr EffectInfo info{
      "zipping_hysteresis",
      Attachment::Pouch,
      "A pouch rises later than the voltage and falls later than it, because zipped films hold on to each "
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
