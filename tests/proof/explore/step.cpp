#include <algorithm>

#include "invariants.hpp"

namespace biopsy::explore {
namespace {

using safety::HazardSet;

// From the safety concept.
constexpr std::int32_t kEnvelopeGone_ms = 250, kHighest_mV = 8'000'000;

constexpr HazardSet kC0 = safety::hazards_with(StopCategory::C0Off);
constexpr HazardSet kC1 = safety::hazards_with(StopCategory::C1Ramp);

}  // namespace

StopCategory Step::strongest_stop(const SupervisorInput& input) {
  const HazardSet hazards = input.evidence.hazards();
  StopCategory needed = hazards != 0 ? StopCategory::C2Hold : StopCategory::None;
  if ((hazards & kC1) != 0) needed = StopCategory::C1Ramp;
  if ((hazards & kC0) != 0) needed = StopCategory::C0Off;
  return std::max(needed, input.stop);
}

std::int32_t envelope_before_mV(const PlanFacts& plan, const SupervisorState& before) {
  switch (before.mode) {
    case Mode::Active:
      return before.stage < plan.stage_count
                 ? std::clamp(plan.stages[before.stage % safety::kMaxStages].v_max_mV, 0, kHighest_mV)
                 : 0;
    case Mode::Hold:
      return before.held_mV;
    case Mode::Retract:
      return static_cast<std::int32_t>(std::int64_t{before.held_mV} *
                                       std::max(kEnvelopeGone_ms - before.ticks_in_mode, 0) /
                                       kEnvelopeGone_ms);
    case Mode::Boot:
    case Mode::Safe:
    case Mode::Ready:
    case Mode::Armed:
    case Mode::Trip:
    case Mode::Lock:
      break;
  }
  return 0;
}

}  // namespace biopsy::explore
