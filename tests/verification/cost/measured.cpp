#include "tests/verification/cost/measured.hpp"

#include <tuple>

#include "tests/safety/situation.hpp"

namespace biopsy::fault_injection {

void measured_step(const safety::PlanFacts& facts, Carried& carried, const TickInput& tick) {
  safety::Situation input = tick.asked;
  input.evidence = safety::assess(facts, carried.memory, tick.seen);
  safety::SupervisorOutput output;
  std::tie(carried.state, output) = safety::step(facts, carried.state, input);
  asm volatile("" : : "r"(&output) : "memory");  // the output is used
}

void measured_gate(Carried& carried, const TickInput& tick) {
  const safety::GateResult result = safety::gate(
      carried.gate, &tick.request, tick.permit_arrives ? &tick.permit : nullptr, tick.gate_us, tick.writers);
  carried.gate = result.state;
  asm volatile("" : : "r"(&result) : "memory");
}

void empty_step(const safety::PlanFacts& facts, Carried& carried, const TickInput& tick) {
  asm volatile("" : : "r"(&facts), "r"(&carried), "r"(&tick) : "memory");
}

void empty_gate(Carried& carried, const TickInput& tick) {
  asm volatile("" : : "r"(&carried), "r"(&tick) : "memory");
}

}  // namespace biopsy::fault_injection
