// Turns what is observed in one tick into explicit evidence: which hazards are known to be absent.
//
// One tick of a lockstep loop (T = 1 ms), in this order:
//   1. stage:       reads sensors                                -> Measurement m[k]   (reports the gate's
//   doing in k-1)
//   2. supervisor:  assess(plan, memory, observation)            -> Evidence           (observation.permit =
//   permit[k-1])
//                   step(plan, state, input)                     -> permit[k]
//   3. controller:  its step(m[k], permit[k])                    -> DriveRequest[k]    (observed in tick k+1)
//   4. gate:        gate(state, &request[k], &permit[k], now, 1) -> GatedVoltage, answer -> actuator
// So m[k].command_mV is the voltage applied since k-1, m[k].monitor_mV may show it or the one before, and
// m[k].answer answers permit[k-1]. The checks below are written for that order and tolerate two ticks more.
#pragma once

#include <cstdint>

#include "safety/monitors/depth_monitor.hpp"
#include "safety/monitors/link_monitor.hpp"
#include "safety/monitors/voltage_monitor.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/plan_facts.hpp"
#include "safety/types/supervisor_inputs.hpp"

namespace biopsy::safety {

// Default-constructed: nothing is known to be absent, nothing is zero, nothing may happen.
struct Evidence {
  HazardSet clear = 0;          // bit set: this hazard was looked for and is absent
  bool zero_volts = false;      // command and monitor below 100 V, three ticks in a row
  bool needle_home = false;     // depth measured and below 1 mm
  bool image_disturbed = true;  // the drive switched while an image was taken: flag the image
  std::int32_t drive_mV = 0;    // |V| the gate put out last
  std::int32_t ceiling_mV = 0;  // no rise beyond: the pull would run ahead of what the needle answered

  constexpr HazardSet hazards() const { return ~clear & kAllHazards; }
};

// What the detectors remember from tick to tick. One per supervisor; default-constructed at start.
struct EvidenceMemory {
  LinkMonitor link;
  VoltageMonitor drive;
  DepthMonitor depth;
};

Evidence assess(const PlanFacts& plan, EvidenceMemory& memory, const SupervisorInputs& seen);

}  // namespace biopsy::safety
