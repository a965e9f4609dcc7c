#pragma once

#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Gain error of the laser.
struct SensorScale {
  double share = 0.0;

  double read(double reading, const ReadingMoment&) const { return reading * (1.0 + share); }

  static constexpr bool linearises = true;
  static constexpr EffectInfo info{
      "sensor_scale",
      Attachment::Sensor,
      "The sensor's gain is wrong: every distance is read too long or too short by the same share.",
      "reading *= 1 + share",
      "closed_loop_steps",
      "calibration error; JCGM 100:2008, F.2.4"};
  static constexpr auto parameters() {
    using E = SensorScale;
    return std::array{Parameter<E>{"share", &E::share, 1.0, -0.9, 9.0, 0.05, "by which readings are too long",
                                   Role::Strength}};
  }
};

}  // namespace biopsy::sim
