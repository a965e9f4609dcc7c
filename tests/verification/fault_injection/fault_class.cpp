#include "tests/verification/fault_injection/fault_class.hpp"

#include <algorithm>

#include "safety/types/limits.hpp"

namespace biopsy::fault_injection {
namespace {

constexpr std::int32_t kC0_ms = 10;  // safety concept: C0 in all
constexpr std::int32_t kTick_ms = 1;

}  // namespace

FaultClass class_of(safety::Hazard hazard, std::vector<Mode> modes, Inject inject) {
  const safety::HazardFacts& facts = safety::kHazardTable[static_cast<std::size_t>(hazard)];
  FaultClass fault;
  fault.modes = std::move(modes);
  fault.inject = inject;
  fault.id = facts.requirement;
  fault.what = facts.name.substr(5);
  fault.hazard = hazard;
  fault.detect_ms = facts.detect_ms;
  switch (facts.stop) {
    case StopCategory::C0Off:
      fault.reaction = facts.locks ? Reaction::Lock : Reaction::Off;
      fault.react_ms = std::max(kC0_ms, facts.detect_ms + kTick_ms);
      break;
    case StopCategory::C1Ramp:
      fault.reaction = Reaction::Ramp;
      fault.react_ms = facts.detect_ms + limits::kRampTime_ms;
      break;
    case StopCategory::C2Hold:
    case StopCategory::None:
      fault.reaction = Reaction::NoRise;
      fault.react_ms = facts.detect_ms + kTick_ms;
      break;
  }
  return fault;
}

std::vector<FaultClass> all_faults() {
  std::vector<FaultClass> all;
  for (auto* some : {drive_faults, needle_faults, sensor_faults, link_faults, plan_faults, message_faults})
    std::ranges::move(some(), std::back_inserter(all));
  std::ranges::stable_sort(all, {}, &FaultClass::id);
  return all;
}

}  // namespace biopsy::fault_injection
