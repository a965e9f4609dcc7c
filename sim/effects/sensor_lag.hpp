#pragma once

#include <array>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// The reading follows the plate as a first-order filter.
struct SensorLag {
  double time = 1e-3;  // s

  double rate(double x, double reading) const { return (x - reading) / time; }

  static constexpr EffectInfo info{"sensor_lag",           Attachment::Sensor,
                                   "The reading is late.", "d reading/dt = (x - reading)/time",
                                   "weight_drop",          "averaging inside a laser triangulation sensor"};
  static constexpr auto parameters() {
    return std::array{
        Parameter<SensorLag>{"time_ms", &SensorLag::time, 1e-3, 0.1, 500.0, 5.0, "time constant"}};
  }
};

}  // namespace biopsy::sim
