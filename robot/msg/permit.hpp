// The supervisor's leave to raise the drive voltage, renewed every tick. No permit, no rise.
#pragma once

#include <cstdint>

namespace biopsy {

enum class Mode : std::uint8_t { Boot, Safe, Ready, Armed, Active, Hold, Retract, Trip, Lock };

// IEC 60204-1 stop categories; a larger value is a stronger stop.
enum class StopCategory : std::uint8_t {
  None,
  C2Hold,  // no rise
  C1Ramp,  // monitored ramp to 0 V, then off
  C0Off,   // 0 V and HV enable off at once
};

struct Permit {
  std::uint32_t session = 0;   // one per start of the supervisor; 0 is never valid
  std::uint32_t epoch = 0;     // raised by every trip: permits of an older epoch are dead
  std::uint32_t seq = 0;       // rises with every permit
  std::int64_t issued_us = 0;  // supervisor's clock, for the log only: the gate ages permits on its own clock
  std::int32_t ttl_us = 0;
  Mode mode = Mode::Boot;
  StopCategory stop = StopCategory::C0Off;
  bool hv_enable = false;
  std::int32_t v_max_mV = 0;               // envelope of |V|
  std::int32_t slew_up_mV_per_tick = 0;    // 0: |V| may not rise
  std::int32_t slew_down_mV_per_tick = 0;  // 0: free; C1 ramps are paced by the envelope
  std::int32_t depth_max_um = 0;
  std::uint64_t plan_tag = 0;  // first 8 bytes of the plan's seal
  std::uint64_t config_tag = 0;
  std::uint32_t challenge = 0;
};

}  // namespace biopsy
