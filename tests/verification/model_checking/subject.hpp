// What is explored: the shipped step and gate, or a copy with a seeded bug behind the same two functions.
#pragma once

#include <utility>

#include "safety/gate.hpp"
#include "safety/supervisor.hpp"
#include "tests/safety/situation.hpp"

namespace biopsy::model_checking {

using safety::PlanFacts;
using safety::Situation;
using safety::SupervisorOutput;
using safety::SupervisorState;

using Stepped = std::pair<SupervisorState, SupervisorOutput>;

// As C entry points, so that a copy can stand behind dlopen. The gate's voltage travels in its state.
struct Subject {
  Stepped (*step)(const PlanFacts*, const SupervisorState*, const Situation*);
  void (*gate)(const safety::GateState*, const DriveRequest*, const Permit*, std::int64_t now_us,
               std::int32_t writer_count, safety::GateState*, std::int32_t* mV, bool* hv_enabled,
               bool* brake_on, GateVerdict*);
};

Subject shipped();

}  // namespace biopsy::model_checking
