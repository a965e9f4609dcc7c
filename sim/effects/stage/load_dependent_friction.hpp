#pragma once

#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Dry friction in proportion to the force that the guide passes on: of a side load, a screw, a seal.
struct LoadDependentFriction {
  double share = 0.0;  // of the drive's push

  double friction_under(double push) const { return share * std::abs(push); }

  static constexpr EffectInfo info{
      "load_dependent_friction",
      Attachment::Stage,
      "Dry friction of the guide grows with the force that drives plate A, as that of a tilted guide or of a "
      "screw does.",
      "F = -share |push| sign(v), push of the series spring, or the driving force; at v = 0 it balances any "
      "net force up to that",
      "weight_drop",
      "Amontons' law; Garrec, Friconneau, Measson, Perrot 2008, IROS: load-dependent friction of a drive"};
  static constexpr auto parameters() {
    return std::array{Parameter<LoadDependentFriction>{"share", &LoadDependentFriction::share, 1.0, 0.0, 0.95,
                                                       0.1, "of the drive's push, either direction",
                                                       Role::Strength}};
  }
};

}  // namespace biopsy::sim
