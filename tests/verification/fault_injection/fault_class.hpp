// A class of faults: what breaks, when it may, what must notice, and what must happen by when.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/verification/fault_injection/procedure.hpp"

namespace biopsy::fault_injection {

// A tick of the sound procedure, to choose the moment by.
struct ProcedureState {
  Mode mode = Mode::Boot;
  std::int32_t drive_mV = 0, depth_um = 0;
  std::int32_t steady = 0;  // ticks since the drive last changed by more than 100 V
  std::int32_t left = 0;    // ticks until this mode ends
};

enum class Reaction : std::uint8_t {
  Off,        // 0 V and HV off, in truth and by the gate
  OutputOff,  // 0 V on the stack, whoever does it
  Ramp,       // the gate's voltage is 0 and the drive off
  NoRise,     // not active, and |V| never rises again
  Lock,       // locked, the gate off
  Flag,       // the image is marked
};

struct FaultClass {
  std::string id;  // R-nn of the hazard, or R-nn/way for one more way to it
  std::string what;
  safety::Hazard hazard = safety::Hazard::None;  // to be named; None: the reaction alone is judged
  safety::HazardSet instead = 0;                 // as strict and explained by the same fault
  Reaction reaction = Reaction::Off;
  std::int32_t detect_ms = 1, react_ms = 10;  // both from the first sample that shows it, that one counted
  std::int32_t row = 1;     // samples in a row that show it, as docs/reference/supervisor.md counts
  std::vector<Mode> modes;  // in which it may begin
  bool (*fits)(const ProcedureState&) = [](const ProcedureState&) { return true; };
  Corruptors (*inject)(Draw&, Procedure&, const TickRecord& now) = nullptr;
  bool moves_needle = false;  // the fault itself is a force on the needle: it, not the drive, makes the depth
  bool raises_drive = false;  // the fault itself is a voltage: judged is when it ends
};

using Inject = Corruptors (*)(Draw&, Procedure&, const TickRecord& now);

inline const std::vector<Mode> kReadyOrDriven{Mode::Ready, Mode::Armed, Mode::Active, Mode::Hold,
                                              Mode::Retract};
inline const std::vector<Mode> kDriven{Mode::Armed, Mode::Active, Mode::Hold, Mode::Retract};
inline const std::vector<Mode> kInserted{Mode::Active, Mode::Hold};

// A class with stop and times of the hazard's row in kHazardTable.
FaultClass class_of(safety::Hazard hazard, std::vector<Mode> modes = {}, Inject inject = nullptr);

std::vector<FaultClass> drive_faults();
std::vector<FaultClass> needle_faults();
std::vector<FaultClass> sensor_faults();
std::vector<FaultClass> link_faults();
std::vector<FaultClass> plan_faults();
std::vector<FaultClass> message_faults();

// All of them, in the order of their ids.
std::vector<FaultClass> all_faults();

}  // namespace biopsy::fault_injection
