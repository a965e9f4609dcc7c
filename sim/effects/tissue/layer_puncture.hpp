#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// A tissue surface bulges ahead of the needle, ruptures at the puncture force and then only resists cutting.
// Its state is the deepest position of the tip: cut tissue stays cut. The cut closes behind the tip, which
// opens it again on every way in.
struct LayerPuncture {
  double depth = 0.0;        // m, where the undeflected surface lies
  double force = 0.0;        // N at puncture
  double deflection = 1e-3;  // m, of the surface at puncture
  double collapse = 0.2e-3;  // m, travel over which the force falls to the cutting force
  double cutting = 0.0;      // N, at the tip once inside
  double reopening = 0.0;    // N, at the tip while it advances along the cut, on top of `cutting`

  // Force at the largest deflection so far: parabola to the puncture, straight fall, then cutting.
  double virgin(double q) const {
    if (q <= 0.0) return 0.0;
    if (q < deflection) return force * (q / deflection) * (q / deflection);
    return std::max(cutting, force - (force - cutting) * (q - deflection) / collapse);
  }

  // Force that pushes the needle back at tip position x, the deepest so far being x_max.
  double push_back(double x, double x_max) const {
    const double q = x - depth;
    const double q_max = std::max(q, x_max - depth);
    if (q_max <= deflection) return virgin(q);
    const double elastic = 0.5 * deflection;  // recoil of cut tissue while the needle withdraws
    return virgin(q_max) * std::clamp(1.0 - (q_max - q) / elastic, 0.0, 1.0);
  }

  // A force against one direction only: half of it constant and half of it dry friction. It sets in while the
  // surface collapses, and where the tip enters.
  double half_reopening(double x, double x_max) const {
    if (!rubs()) return 0.0;
    const double inside = std::clamp((x - depth) / deflection, 0.0, 1.0);
    const double open = std::clamp((std::max(x, x_max) - depth - deflection) / collapse, 0.0, 1.0);
    return 0.5 * reopening * inside * open;
  }

  double load(const PlateMotion& a) const { return push_back(a.x, a.x_max) + half_reopening(a.x, a.x_max); }
  bool rubs() const { return reopening > 0.0; }
  double dry_friction(const PlateMotion& a) const { return half_reopening(a.x, a.x_max); }
  bool punctured(double x_max) const { return x_max - depth > deflection; }
  Steepness steepest(const Reach&) const {
    const double highest = std::max(force, cutting);
    return {.stiffness = std::max({2.0 * force / deflection, std::abs(force - cutting) / collapse,
                                   2.0 * highest / deflection}) +
                         0.5 * reopening * std::max(1.0 / deflection, 1.0 / collapse)};
  }

  static constexpr bool acts_by_position = true;
  static constexpr EffectInfo info{
      "layer_puncture",
      Attachment::Tissue,
      "The needle meets a tissue surface that bulges, then ruptures at once and lets the needle jump "
      "forward.",
      "F = force (q/deflection)^2 up to the puncture, then a straight fall to `cutting` over `collapse`; "
      "with "
      "`reopening` where the tip advances in what is cut",
      "slow_triangle",
      "Okamura, Simone, O'Leary 2004, IEEE TBME 51(10); Mahvash, Dupont 2010, IEEE TBME 57(4)"};
  static constexpr auto parameters() {
    using E = LayerPuncture;
    return std::array{
        Parameter<E>{"depth_mm", &E::depth, 1e-3, -1e4, 1e4, 2.0,
                     "position of the surface before it is touched", Role::Place},
        Parameter<E>{"force_N", &E::force, 1.0, 0.0, 1e4, 0.2, "puncture force", Role::Strength},
        Parameter<E>{"deflection_mm", &E::deflection, 1e-3, 0.001, 1e3, 0.3, "bulge at that force",
                     Role::Shape},
        Parameter<E>{"collapse_mm", &E::collapse, 1e-3, 0.001, 1e3, 0.2,
                     "travel over which the force collapses", Role::Shape},
        Parameter<E>{"cutting_N", &E::cutting, 1.0, 0.0, 1e4, 0.05, "force at the tip while cutting on",
                     Role::Strength},
        Parameter<E>{"reopening_N", &E::reopening, 1.0, 0.0, 1e4, 0.05,
                     "further force while advancing where the tissue is cut", Role::Strength, kMayBeLeftOut}};
  }
};

}  // namespace biopsy::sim
