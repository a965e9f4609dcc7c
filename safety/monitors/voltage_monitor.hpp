// Monitors the high voltage: monitor, current, polarity, compliance of the driver with the permit, residual
// charge.
#pragma once

#include <array>
#include <cstdint>

#include "safety/types/hazards.hpp"
#include "safety/types/plan_facts.hpp"
#include "safety/types/supervisor_inputs.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::safety {

// Of a permit, what the driver's voltage, enable and brake are compared with.
struct Permitted {
  std::int32_t v_max_mV = 0;
  bool hv_enable = false, brake = false;
};

struct VoltageMonitor {
  std::array<Permitted, 8> permitted{};     // by the permits' numbers
  HazardSet found = 0;                      // stands until the next new measurement
  std::int32_t command_mV = 0;              // of the last measurement
  std::array<std::int64_t, 2> change_mV{};  // |change of command| one and two measurements ago
  std::int32_t over_ticks = 0, arc_score = 0, disagree_score = 0, disobey_ticks = 0;
  std::int32_t zero_ticks = 0, nonzero_ticks = 0;
  bool zero_volts = false;
  std::int32_t off_ticks = 0;                    // measurements since the drive was to be off
  std::int64_t signed_mVms = 0, total_mVms = 0;  // integrals of V and |V|, forgetting
  std::int32_t wave_ticks = 0;                   // integrated so far
  std::array<std::int64_t, 4>
      flip_tick{};  // the last four changes of polarity, newest first, and the wave's begin
  std::int32_t flips = 0;
  std::int64_t tick = 0;
  std::int32_t polarity = 0;
  bool wrong_frequency = false;
  std::int64_t pull_V2 = 0;  // mean of V^2 over kPull_ticks, to which the pull of the pouches is proportional
  std::int32_t ceiling_mV = 0;
  bool brake_on = false;       // in the last measurement
  std::int32_t locked_mV = 0;  // |V| when the brake took the needle
};

struct DriveFindings {
  HazardSet found = 0;
  bool zero_volts = false;
  bool image_disturbed = true;
  std::int32_t drive_mV = 0;
  // |V| beyond which the pull would lead its mean by too much, or a locked needle would jump when it is let
  // go
  std::int32_t ceiling_mV = 0;
};

// `fresh`: the measurement is new; `stale`: none for more than 3 ms.
DriveFindings update(const PlanFacts& plan, VoltageMonitor& monitor, const SupervisorInputs& seen, bool fresh,
                     bool stale);

}  // namespace biopsy::safety
