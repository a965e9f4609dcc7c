// From the inputs of a tick to evidence: which hazards are known to be absent.
//
// Order within a tick k of 1 ms (robot/cycle):
//   1. measure     m[k]: sensors, and what the gate did in k-1
//   2. supervise   assess(plan, memory, inputs) -> evidence;  step(plan, state, inputs, evidence) ->
//   permit[k]
//   3. control     m[k], permit[k] -> request[k], an input of the supervisor in k+1
//   4. actuate     gate(request[k], permit[k]) -> voltage, answer
// m[k].command_mV is the voltage applied since k-1, m[k].monitor_mV may show it or the one before, and
// m[k].answer answers permit[k-1]. The monitors tolerate two ticks more.
#pragma once

#include <cstdint>

#include "safety/monitors/agreement_monitor.hpp"
#include "safety/monitors/depth_monitor.hpp"
#include "safety/monitors/link_monitor.hpp"
#include "safety/monitors/panel_monitor.hpp"
#include "safety/monitors/voltage_monitor.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/plan_facts.hpp"
#include "safety/types/supervisor_inputs.hpp"

namespace biopsy::safety {

// Default-constructed: nothing is known to be absent, nothing is zero, nothing may happen.
struct Evidence {
  HazardSet clear = 0;           // bit set: this hazard was looked for and is absent
  bool zero_volts = false;       // command and monitor below 100 V, three ticks in a row
  bool needle_home = false;      // depth measured and below 1 mm
  bool needle_back = false;      // and within 0.1 mm of where it waits
  bool image_disturbed = true;   // the drive switched while an image was taken: flag the image
  bool locked = false;           // the brake has the needle
  bool still = false;            // and it has not moved, for no longer than it may last, at 0 V
  bool interlock_opens = false;  // proven in Boot, on the driver's timer alone
  bool estop_reset = false;      // the reset key released the emergency stop in this tick
  std::int32_t elapsed_ms = 1;   // on the supervisor's clock since the last tick
  std::int32_t drive_mV = 0;     // |V| the gate put out last
  std::int32_t ceiling_mV = 0;   // no rise beyond: the pull would lead the needle's response

  constexpr HazardSet hazards() const { return ~clear & kAllHazards; }
};

// Memory of the monitors. One per supervisor; default-constructed at start.
struct EvidenceMemory {
  LinkMonitor link;
  PanelMonitor panel;
  VoltageMonitor drive;
  DepthMonitor depth;
  AgreementMonitor agreement;
};

Evidence assess(const PlanFacts& plan, EvidenceMemory& memory, const SupervisorInputs& seen);

}  // namespace biopsy::safety
