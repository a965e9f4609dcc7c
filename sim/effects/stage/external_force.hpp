#pragma once

#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// A constant push on plate A that the run does not describe.
struct ExternalForce {
  double force = 0.0;  // N, down positive, as F_ext

  double load(const PlateMotion&) const { return force; }

  static constexpr EffectInfo info{
      "external_force", Attachment::Stage, "A constant force that the run does not describe acts on plate A.",
      "F_ext += force", "weight_drop",     "paper eq. (14), F_ext; a taut cable or a tilted guide"};
  static constexpr auto parameters() {
    using E = ExternalForce;
    return std::array{
        Parameter<E>{"force_N", &E::force, 1.0, -1e4, 1e4, 0.05, "pushes plate A down", Role::Strength}};
  }
};

}  // namespace biopsy::sim
