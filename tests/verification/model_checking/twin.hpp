// A twin of a step differs from it in everything the exploration forgets: names of session, epoch and tokens,
// timers and voltages of other modes, which hazard of a class, inputs that decide nothing in this mode, what
// is asked over the network. It must do the same; that is what makes the abstraction sound.
#pragma once

#include "inputs.hpp"
#include "states.hpp"
#include "subject.hpp"
#include "tests/safety/situation.hpp"

namespace biopsy::explore {

struct Twin {
  SupervisorState state;
  Situation input;
};

// `number` chooses the differences; another number, another twin.
Twin twin_of(const SupervisorState& state, const Situation& input, std::uint64_t number);

// Whether two steps of twins did the same, each seen from where it started.
bool did_the_same(const SupervisorState& next, const SupervisorOutput& output,
                  const SupervisorState& twin_before, const SupervisorState& twin_next,
                  const SupervisorOutput& twin_output);

}  // namespace biopsy::explore
