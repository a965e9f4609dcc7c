// What the controller asks of the gate.
#pragma once

#include <cstdint>

namespace biopsy {

struct DriveRequest {
  std::uint32_t seq = 0;           // rises every tick
  std::int32_t wanted_mV = 0;      // signed: amplitude times the square wave's polarity
  std::uint32_t stage = 0;         // index of the stage being driven
  bool stage_reached = false;      // within tolerance for the stage's dwell: asks for Hold
  bool finished = false;           // last stage confirmed: asks for Retract
  std::uint32_t overruns = 0;      // control periods missed since start
  std::uint32_t measured_seq = 0;  // of the measurement it was made from; for timing, decides nothing
  std::int32_t setpoint_um = 0;    // the rate-limited target depth, for people
  std::uint64_t plan_tag = 0;      // of the plan that it runs; 0: none
  std::uint64_t config_tag = 0;    // of the configuration that it was started with
};

}  // namespace biopsy
