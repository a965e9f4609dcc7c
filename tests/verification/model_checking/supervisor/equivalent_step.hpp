// A equivalent of a step differs from it in everything the exploration forgets: names of session, epoch and
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

// Whether two steps of equivalent_steps did the same, each seen from where it started.
bool has_equal_outcome(const SupervisorState& next, const SupervisorOutput& output,
                       const SupervisorState& other_before, const SupervisorState& other_next,
                       const SupervisorOutput& other_output);

}  // namespace biopsy::model_checking
