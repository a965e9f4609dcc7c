#include "tests/verification/cost/measured.hpp"

#include <tuple>

#include "tests/safety/situation.hpp"

namespace biopsy::proof {

void measured_step(const safety::PlanFacts& facts, Carried& carried, const Beat& beat) {
  safety::Situation input = beat.asked;
  input.evidence = safety::assess(facts, carried.memory, beat.seen);
  safety::SupervisorOutput output;
  std::tie(carried.state, output) = safety::step(facts, carried.state, input);
  asm volatile("" : : "r"(&output) : "memory");  // the output is used
}

void measured_gate(Carried& carried, const Beat& beat) {
  const safety::GateResult result = safety::gate(
      carried.gate, &beat.request, beat.permit_arrives ? &beat.permit : nullptr, beat.gate_us, beat.writers);
  carried.gate = result.state;
  asm volatile("" : : "r"(&result) : "memory");
}

void empty_step(const safety::PlanFacts& facts, Carried& carried, const Beat& beat) {
  asm volatile("" : : "r"(&facts), "r"(&carried), "r"(&beat) : "memory");
}

void empty_gate(Carried& carried, const Beat& beat) {
  asm volatile("" : : "r"(&carried), "r"(&beat) : "memory");
}

}  // namespace biopsy::proof
