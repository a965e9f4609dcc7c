#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// The films keep part of the largest deformation M, which decays with time: the pouch cannot fall below a
// floor, and a height is added that is 0 during the first loading (M = H - H_0) and added_share M after
// unloading (H = H_0).
struct ResidualSet {
  double floor_share = 0.0;  // of M, the floor of H - H_0
  double added_share = 0.0;  // of M - (H - H_0) that is added to the pouch
  double time = 30.0;        // s, of the decay of M

  struct State {
    double largest = 0.0;  // m, M
  };
  double faded(double memory, double h) const { return memory * std::exp(-h / time); }
  double remembered(double memory, double deflection) const { return std::max(memory, deflection); }
  double added(double memory, double deflection) const {
    return added_share * std::max(0.0, memory - deflection);
  }
  PouchOffset pouch_offset(const PouchMotion& p, const State& own) const {
    const double largest = faded(own.largest, p.since);
    const bool recovering = largest > p.deflection;
    return {.height = added(largest, p.deflection),
            .rate = recovering ? -added_share * largest / time : 0.0,
            .per_H = recovering ? -added_share : 0.0,
            .floor = p.H_0 + floor_share * remembered(largest, p.deflection)};
  }
  void remember(const Moved& now, State& own) const {
    own.largest = remembered(faded(own.largest, now.h), now.deflection);
  }
  void settle(const SteadyMotion& now, State& own) const {
    own.largest = remembered(own.largest, now.deflection);
  }

  static constexpr EffectInfo info{
      "residual_set",
      Attachment::Pouch,
      "After a large lift the films keep a small deformation, which recovers over tens of seconds.",
      "M >= H - H_0, dM/dt = -M/time; H >= H_0 + floor_share M; x_B = n (H - H_0 + added_share (M - H + "
      "H_0))",
      "voltage_staircase_up_and_down",
      "Ward, Sweeney 2012, Mechanical Properties of Solid Polymers, 3rd ed., ch. 11: recovery after yield"};
  static constexpr auto parameters() {
    using E = ResidualSet;
    return std::array{
        Parameter<E>{"floor_share", &E::floor_share, 1.0, 0.0, 0.95, 0.2,
                     "of the largest deformation, below which a pouch does not fall", Role::Strength},
        Parameter<E>{"added_share", &E::added_share, 1.0, 0.0, 0.95, 0.1,
                     "of the largest deformation, added to the height after unloading", Role::Strength},
        Parameter<E>{"time_s", &E::time, 1.0, 0.1, 1e5, 30.0, "time constant of the recovery", Role::Shape}};
  }
};

}  // namespace biopsy::sim
