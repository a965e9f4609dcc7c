// Every kind of fault of the depth sensor, the monitors and the drive, each in sizes from harmless to gross.
// The sizes are what such parts are known to do when they fail; no monitor's threshold is looked at.
#pragma once

#include <string>
#include <vector>

#include "sim/faults/fault.hpp"

namespace biopsy::robot {

enum class FaultBegin : std::uint8_t {
  Start,   // with the run, before anything is armed
  Motion,  // at a depth on the way to the target, drawn for each run
};

struct FaultEntry {
  std::string name;  // "depth frozen, noise 0.01 mm"
  FaultBegin begin = FaultBegin::Motion;
  std::vector<sim::Fault> faults;  // of Motion: `from_depth_mm` is set for each run
};

std::vector<FaultEntry> fault_grid();

}  // namespace biopsy::robot
