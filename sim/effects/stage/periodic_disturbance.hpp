#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Force or motion at one frequency: breathing, a pump, the table. Its phase is that at the beginning of the
// run.
struct PeriodicDisturbance {
  double force = 0.0;       // N, up on plate A
  double motion = 0.0;      // m, of what is measured against the sensor
  double frequency = 0.25;  // Hz
  double phase = 0.0;       // rad

  double wave(double t) const { return std::sin(2.0 * std::numbers::pi * frequency * t + phase); }
  double load(const PlateMotion& a) const { return -force * wave(a.time); }
  double target_motion(double time) const { return motion * wave(time); }
  Steepness steepest(const Reach&) const { return {.rate = 2.0 * std::numbers::pi * frequency}; }

  static constexpr EffectInfo info{
      "periodic_disturbance",
      Attachment::Stage,
      "A disturbance at one frequency acts on the stage: breathing, a pump, the table.",
      "F = force sin(2 pi f t + phase), reading += motion sin(2 pi f t + phase)",
      "dc_hold",
      "Seppenwoolde et al. 2002, Int. J. Radiat. Oncol. 53(4): breathing at "
      "0.2 to 0.4 Hz"};
  static constexpr auto parameters() {
    using E = PeriodicDisturbance;
    return std::array{
        Parameter<E>{"force_N", &E::force, 1.0, 0.0, 1e4, 0.02, "amplitude of the force", Role::Strength},
        Parameter<E>{"motion_mm", &E::motion, 1e-3, 0.0, 1e3, 0.02, "amplitude seen by the sensor",
                     Role::Strength},
        Parameter<E>{"frequency_Hz", &E::frequency, 1.0, 0.001, 1e4, 0.25, "of both", Role::Frequency},
        Parameter<E>{"phase_deg", &E::phase, std::numbers::pi / 180.0, -360.0, 360.0, 0.0,
                     "at the beginning of the run", Role::Phase}};
  }
};

}  // namespace biopsy::sim
