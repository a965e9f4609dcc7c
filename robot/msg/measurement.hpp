// What the stage reports once per tick: sensors, and what its gate did with the last request.
#pragma once

#include <cstdint>

namespace biopsy {

// Why the gate put out less than was wanted. Granted is the only good news.
enum class GateVerdict : std::uint8_t {
  Refused,  // nothing known: the default
  Granted,
  NoPermit,  // none seen yet
  WrongSession,
  OldEpoch,
  OldSequence,  // duplicate, replay or reordering
  Expired,      // on the stage's own monotonic clock
  SecondWriter,
  ClockJump,
  NoRequest,  // the controller is silent
  Limited,    // lowered to the permit's envelope or slew
};

struct Measurement {
  std::uint32_t seq = 0;
  std::int64_t time_us = 0;     // stage's monotonic clock
  std::int32_t depth_um = 0;    // laser, displacement of plate A
  std::int32_t laser_code = 0;  // raw converter code, to see a frozen sensor
  bool laser_valid = false;     // target in range and enough light
  std::int32_t monitor_mV = 0;  // amplifier's voltage monitor, in mV of high voltage, signed
  std::int32_t current_nA = 0;  // amplifier's current monitor
  std::int32_t command_mV = 0;  // what the gate put on the converter in the last tick, signed
  bool hv_enabled = false;
  // Answer to the last honoured permit's challenge; see safety/gate.hpp.
  std::uint32_t answer = 0;
  std::uint32_t answered_seq = 0;
  GateVerdict verdict = GateVerdict::Refused;
  std::uint64_t config_tag = 0;  // of the configuration that the stage was started with
};

}  // namespace biopsy
