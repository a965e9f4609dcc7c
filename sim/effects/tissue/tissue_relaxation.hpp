#pragma once

#include <algorithm>
#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Maxwell element: tissue dragged along by the shaft pulls back, and relaxes with time.
struct TissueRelaxation {
  double from = 0.0;       // m, where this tissue begins
  double stiffness = 0.0;  // N/m
  double time = 1.0;       // s

  using State = double;  // m, how far the tissue has crept

  double inserted(double x) const { return std::max(0.0, x - from); }
  // Force against the needle when the tissue has crept by `crept` (m), and the rate of that creep. The state
  // is the creep and not the spring's stretch, so that the force is continuous where the needle enters.
  double push_back(double x, double crept) const { return stiffness * (inserted(x) - crept); }
  double rate(double x, double crept) const { return (inserted(x) - crept) / time; }
  double load(const PlateMotion& a, double crept) const { return push_back(a.x, crept); }
  double state_rate(const Flow& f, double crept) const { return rate(f.x, crept); }
  Steepness steepest(const Reach&) const { return {.stiffness = stiffness, .rate = 1.0 / time}; }

  static constexpr bool acts_by_position = true;
  static constexpr EffectInfo info{
      "tissue_relaxation",
      Attachment::Tissue,
      "Tissue dragged along by the shaft pulls back; that force relaxes over seconds while the needle rests.",
      "F = -stiffness (inserted - crept), d crept/dt = (inserted - crept)/time",
      "closed_loop_steps",
      "Maxwell element; Fung 1993, Biomechanics, ch. 7: soft tissue relaxes over seconds"};
  static constexpr auto parameters() {
    using E = TissueRelaxation;
    return std::array{
        Parameter<E>{"from_mm", &E::from, 1e-3, -1e4, 1e4, 0.0, "where the tissue begins", Role::Place},
        Parameter<E>{"stiffness_N_per_mm", &E::stiffness, 1e3, 0.0, 1e6, 0.05, "instantaneous stiffness",
                     Role::Strength},
        Parameter<E>{"time_s", &E::time, 1.0, 0.01, 1e4, 2.0, "time in which the force falls to 1/e",
                     Role::Shape}};
  }
};

}  // namespace biopsy::sim
