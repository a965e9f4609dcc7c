// Interface of the needle stage: sensors in, gated voltage out. Implemented by the simulated stage and by the
// hardware.
#pragma once

#include <cstdint>

#include "safety/gate.hpp"

namespace biopsy::drivers {

// Readings of the sensors, without the gate's report. Units as in Measurement.
struct SensorReading {
  std::int64_t time_us = 0;
  std::int32_t depth_um = 0;
  std::int32_t laser_code = 0;
  bool laser_valid = false;
  std::int32_t depth_b_um = 0;  // second laser
  bool laser_b_valid = false;
  std::int32_t monitor_mV = 0;
  std::int32_t current_nA = 0;
  bool brake_fitted = false;  // the stage can lock the needle
};

class NeedleStage {
 public:
  virtual ~NeedleStage() = default;
  // Newest reading of every sensor; called once at the beginning of each tick.
  virtual SensorReading read() = 0;
  // Puts a voltage on the converter and locks the needle or lets it go, until the next call. Returns what the
  // converter was given, signed mV: a driver that limited the voltage or could not write it does not say the
  // one it was asked for.
  virtual std::int32_t write(const safety::GatedVoltage& voltage) = 0;
};

}  // namespace biopsy::drivers
