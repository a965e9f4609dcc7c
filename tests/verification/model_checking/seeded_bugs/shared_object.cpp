// The supervisor and the gate as one shared object: compiled from a copy of safety/ with one seeded bug, and
// once from an unchanged copy. Not part of any other program.
#include <utility>

#include "safety/decide.cpp"
#include "safety/gate.cpp"
#include "safety/supervisor.cpp"
#include "safety/types/transitions.cpp"
#include "tests/safety/situation.hpp"

using namespace biopsy;

extern "C" __attribute__((visibility("default"))) std::pair<safety::SupervisorState, safety::SupervisorOutput>
seeded_step(const safety::PlanFacts* plan, const safety::SupervisorState* state,
            const safety::Situation* input) {
  return safety::step(*plan, *state, *input);
}

extern "C" __attribute__((visibility("default"))) void seeded_gate(
    const safety::GateState* state, const DriveRequest* request, const Permit* permit, std::int64_t now_us,
    std::int32_t writer_count, safety::GateState* next, std::int32_t* mV, bool* hv_enabled, bool* brake_on,
    GateVerdict* verdict) {
  const safety::GateResult result = safety::gate(*state, request, permit, now_us, writer_count);
  *next = result.state;
  *mV = result.voltage.mV();
  *hv_enabled = result.voltage.hv_enabled();
  *brake_on = result.voltage.brake_on();
  *verdict = result.verdict;
}
