#pragma once

#include <algorithm>
#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Zipping needs more pressure than staying zipped: a play between the height that pressure asks for and the
// height that the pouch goes to.
struct ZippingHysteresis {
  double width = 0.0;  // m of height per pouch, full width of the loop

  // The play operator: the zipped height stays where it was while pressure asks for anything within the play.
  double zipped(double asked, double before) const {
    return std::clamp(before, asked - 0.5 * width, asked + 0.5 * width);
  }

  static constexpr EffectInfo info{
      "zipping_hysteresis",
      Attachment::Pouch,
      "A pouch rises later than the voltage and falls later than it, because zipped films hold on to each "
      "other.",
      "H_zip = clamp(H_zip, H_eq - width/2, H_eq + width/2), never below H_0",
      "voltage_staircase_up_and_down",
      "Prandtl play operator; paper Fig. 8b: loop of about 30 % of the largest strain"};
  static constexpr auto parameters() {
    return std::array{Parameter<ZippingHysteresis>{"width_mm", &ZippingHysteresis::width, 1e-3, 0.0, 5.0, 0.1,
                                                   "full width of the loop, height of one pouch",
                                                   Role::Strength}};
  }
};

}  // namespace biopsy::sim
