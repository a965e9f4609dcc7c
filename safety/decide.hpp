// The decision of one tick: the event that counts, worst first, and the answer to a refused request.
#pragma once

#include <cstdint>

#include "safety/supervisor.hpp"

namespace biopsy::safety {

// Inputs of the guards of one tick.
struct TransitionInputs {
  const PlanFacts& plan;
  const SupervisorState& state;
  const SupervisorInputs& input;
  const Evidence& evidence;
  HazardSet hazards;
  StopCategory stop;  // the strongest of those requested and needed
  std::int32_t ms;    // in this mode, this tick included
  bool pressed;       // a token never seen before, held
  bool arm_edge, reset_edge;
};

TransitionInputs transition_inputs(const PlanFacts& plan, const SupervisorState& state,
                                   const SupervisorInputs& input, const Evidence& evidence);

// One guard a line, the worst first; None where nothing changes the mode.
Event event_of(const TransitionInputs& t);

// Why a request of this tick was not followed, given the event that was.
Refusal refusal_of(const TransitionInputs& t, Event event);

}  // namespace biopsy::safety
