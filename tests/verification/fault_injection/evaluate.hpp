// Outcome of one corrupted run: detected, late or missed, with its times and extremes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tests/verification/fault_injection/fault_class.hpp"

namespace biopsy::fault_injection {

enum class Outcome : std::uint8_t {
  Detected,
  ByAnother,  // another hazard, as strict and explained by the same fault, came first
  Late,       // named or stopped, but not within its time
  Missed,
  NotShown,  // the fault never became one: nothing to detect
};

struct Verdict {
  Outcome outcome = Outcome::NotShown;
  std::int32_t detect_ms = 0, react_ms = 0;  // from the first sample that shows it, that one counted
  std::int32_t from_fault_ms = 0;            // reaction, from the tick the fault began
  double beyond_mm = 0.0;                    // deepest true depth, minus the target's
  double highest_kV = 0.0;                   // true |V|; of a fault that is a voltage: after the reaction
  bool rose = false;                         // |V| of the gate rose again after the reaction
};

// Depth never beyond the plan's by more than this, |V| never above this.
inline constexpr double kBeyondMax_mm = 2.0, kDriveMax_kV = 8.0;

bool has_reacted(const FaultClass& fault, const TickRecord& line);
Verdict evaluate(const FaultClass& fault, std::span<const TickRecord> lines, double target_mm);

std::string_view name_of(Outcome outcome);

}  // namespace biopsy::fault_injection
