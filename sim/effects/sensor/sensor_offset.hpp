#pragma once

#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// Zero error of the laser.
struct SensorOffset {
  double offset = 0.0;  // m, added to every reading

  double read(double reading, const ReadingMoment&) const { return reading + offset; }

  static constexpr bool linearises = true;
  static constexpr EffectInfo info{"sensor_offset",
                                   Attachment::Sensor,
                                   "The sensor's zero is wrong: every reading is off by the same amount.",
                                   "reading = x + offset",
                                   "closed_loop_steps",
                                   "calibration error"};
  static constexpr auto parameters() {
    return std::array{Parameter<SensorOffset>{"offset_mm", &SensorOffset::offset, 1e-3, -1e3, 1e3, 0.1,
                                              "added to every reading", Role::Strength}};
  }
};

}  // namespace biopsy::sim
