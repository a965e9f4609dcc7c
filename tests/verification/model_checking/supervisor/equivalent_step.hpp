// An equivalent of a step differs from it in everything the exploration forgets: names of session, epoch and
// tokens, timers and voltages of other modes, which hazard of a class, inputs that decide nothing in this
// mode, what is asked over the network. It must do the same; that is what makes the abstraction sound.
#pragma once

#include "tests/safety/situation.hpp"
#include "tests/verification/model_checking/subject.hpp"
#include "tests/verification/model_checking/supervisor/inputs.hpp"
#include "tests/verification/model_checking/supervisor/states.hpp"

namespace biopsy::model_checking {

struct EquivalentStep {
  SupervisorState state;
  Situation input;
};

// `number` chooses the differences; another number, another equivalent.
EquivalentStep equivalent_step(const SupervisorState& state, const Situation& input, std::uint64_t number);

// The same into one that an equivalent of the same input, or of another that differs in the dimensions of
// inputs.hpp alone, was written to before.
void write_equivalent_step(const SupervisorState& state, const Situation& input, std::uint64_t number,
                           EquivalentStep& equivalent);

// Whether two equivalent steps did the same, each seen from where it started. `key`: of the state after the
// first.
bool has_equal_outcome(std::uint64_t key, const Stepped& step, const SupervisorState& other_before,
                       const Stepped& other_step);

}  // namespace biopsy::model_checking
