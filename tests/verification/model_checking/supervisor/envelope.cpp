#include <algorithm>

#include "tests/safety/situation.hpp"
#include "tests/verification/model_checking/supervisor/invariants.hpp"

namespace biopsy::model_checking {
namespace {

using safety::HazardSet;

// From the safety concept.
constexpr std::int32_t kEnvelopeGone_ms = 250, kHighest_mV = 8'000'000;

const HazardSet kC0 = safety::hazards_with(StopCategory::C0Off);
const HazardSet kC1 = safety::hazards_with(StopCategory::C1Ramp);

}  // namespace

StopCategory Step::strongest_stop(const Situation& input) {
  const HazardSet hazards = input.evidence.hazards();
  StopCategory needed = hazards != 0 ? StopCategory::C2Hold : StopCategory::None;
  if ((hazards & kC1) != 0) needed = StopCategory::C1Ramp;
  if ((hazards & kC0) != 0) needed = StopCategory::C0Off;
  return std::max(needed, input.stop);
}

std::int32_t envelope_mV(const PlanFacts& plan, const SupervisorState& state, const Situation& input) {
  switch (state.mode) {
    case Mode::Active:
      return state.step < plan.step_count
                 ? std::clamp(std::min(plan.steps[state.step % safety::kMaxSteps].v_max_mV,
                                       input.evidence.ceiling_mV),
                              0, kHighest_mV)
                 : 0;
    case Mode::Hold:
      return state.held_mV;
    case Mode::Retract:
      return static_cast<std::int32_t>(std::int64_t{state.held_mV} *
                                       std::max(kEnvelopeGone_ms - state.ms_in_mode, 0) / kEnvelopeGone_ms);
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

}  // namespace biopsy::model_checking
