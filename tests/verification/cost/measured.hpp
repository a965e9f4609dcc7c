// The two calls whose cost is counted, under names that callgrind can find; and the same two, empty.
#pragma once

#include "tests/verification/cost/stream.hpp"

namespace biopsy::fault_injection {

// What both carry from tick to tick.
struct Carried {
  safety::EvidenceMemory memory;
  safety::SupervisorState state = safety::started(1);
  safety::GateState gate;
};

extern "C" {
// One tick of the supervisor: evidence and step.
void measured_step(const safety::PlanFacts& facts, Carried& carried, const TickInput& tick);
void measured_gate(Carried& carried, const TickInput& tick);
void empty_step(const safety::PlanFacts& facts, Carried& carried, const TickInput& tick);
void empty_gate(Carried& carried, const TickInput& tick);
}

}  // namespace biopsy::fault_injection
