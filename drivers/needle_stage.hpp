// The needle stage as the robot sees it: sensors in, a gated voltage out. Implemented by the simulated stage
// and by the laboratory hardware; nothing above this line knows which.
#pragma once

#include <cstdint>

#include "safety/gate.hpp"

namespace biopsy::drivers {

// What the sensors say, before the gate's own report is added. Units as in Measurement.
struct SensorReading {
  std::int64_t time_us = 0;
  std::int32_t depth_um = 0;
  std::int32_t laser_code = 0;
  bool laser_valid = false;
  std::int32_t monitor_mV = 0;
  std::int32_t current_nA = 0;
};

class NeedleStage {
 public:
  virtual ~NeedleStage() = default;
  // Newest reading of every sensor; called once at the beginning of each tick.
  virtual SensorReading read() = 0;
  // Puts a voltage on the converter, where it stays until the next call.
  virtual void write(const safety::GatedVoltage& voltage) = 0;
};

}  // namespace biopsy::drivers
