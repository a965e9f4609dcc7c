#pragma once

#include <array>
#include <cmath>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Drift of the reading from the beginning of the run, ever slower: warm-up of the sensor.
struct SensorDrift {
  double rate = 0.0;       // m/s at the beginning
  double settles = 100.0;  // s

  double offset(double t) const { return rate * settles * -std::expm1(-t / settles); }
  double read(double reading, const ReadingMoment& at) const { return reading + offset(at.time); }

  static constexpr EffectInfo info{
      "sensor_drift",
      Attachment::Sensor,
      "The reading drifts although nothing moves.",
      "reading += rate settles (1 - exp(-t/settles))",
      "dc_hold",
      "warm-up of a laser triangulation sensor; Dorsch, Haeusler, Herrmann 1994, "
      "Applied Optics 33(7)"};
  static constexpr auto parameters() {
    using E = SensorDrift;
    return std::array{
        Parameter<E>{"rate_um_per_s", &E::rate, 1e-6, -1e4, 1e4, 1.0, "at the beginning", Role::Strength},
        Parameter<E>{"settles_s", &E::settles, 1.0, 0.1, 1e6, 100.0, "time constant with which it settles",
                     Role::Shape}};
  }
};

}  // namespace biopsy::sim
