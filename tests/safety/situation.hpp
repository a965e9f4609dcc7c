// A tick as a test of the decision alone sets it up: inputs, and the evidence that the monitors would have
// given.
#pragma once

#include <utility>

#include "safety/supervisor.hpp"

namespace biopsy::safety {

// Nobody requests a stop; nothing is known to be absent.
struct Situation : SupervisorInputs {
  Situation() { stop = StopCategory::None; }
  Evidence evidence;
};

inline std::pair<SupervisorState, SupervisorOutput> step(const PlanFacts& plan, const SupervisorState& state,
                                                         const Situation& situation) {
  return step(plan, state, situation, situation.evidence);
}

}  // namespace biopsy::safety
