#pragma once

#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Mass that the run does not describe: its weight and inertia act on plate A.
struct AddedMass {
  double mass = 0.0;  // kg; negative: less than described

  double added_mass() const { return mass; }

  static constexpr bool linearises = true;
  static constexpr EffectInfo info{"added_mass",
                                   Attachment::Stage,
                                   "Plate A carries more (or less) than the run's description says.",
                                   "m_A += mass; with drive = force: m += mass",
                                   "weight_drop",
                                   "a cable, a holder, a weight misread"};
  static constexpr auto parameters() {
    using E = AddedMass;
    return std::array{
        Parameter<E>{"mass_g", &E::mass, 1e-3, -1e6, 1e7, 10.0, "beyond what is described", Role::Strength}};
  }
};

}  // namespace biopsy::sim
