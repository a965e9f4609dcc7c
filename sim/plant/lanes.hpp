// Eight stages side by side, each quantity an array over them, so that one instruction works on several.
// What a lane can be: baseline, added mass and Coulomb friction, on a stack whose amplifier has no lag.
#pragma once

#include <cstddef>

namespace biopsy::sim {

inline constexpr std::size_t kLanes = 8;

using PerLane = double[kLanes];

// Of the models, SI; what the formulas of mechanics.cpp and pouch.hpp combine of constants, combined as there.
struct LaneConstants {
  PerLane K, C1, mass, mass_g, H_0, n, k, c_k, c_k_n, c_s, tau_h, load_B;
  PerLane permittivity, film, L0, a, a_H;  // of pressure and equilibrium
  PerLane friction;                        // N, dry
  PerLane dry;                             // 1: can be held by friction
  PerLane half_decay;                      // of the stack's voltage over half a step
};

struct LaneStates {
  PerLane H, x, v, u_i, u_o, charge, x_max, time;
};

struct LaneInputs {
  PerLane voltage, external_force;
};

// All lanes after h (s). `event`: 1 where plate A stopped, broke away or would not hold: what `after` says of
// that lane is void.
void advance_lanes(const LaneConstants& c, const LaneStates& before, const LaneInputs& inputs, double h,
                   LaneStates& after, PerLane& event);

}  // namespace biopsy::sim
