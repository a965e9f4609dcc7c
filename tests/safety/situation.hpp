// A tick as a test of the decision alone sets it up: inputs, and the evidence that the monitors would have
// given.
#pragma once

#include <utility>

#include "safety/supervisor.hpp"
#include "tests/safety/plan.hpp"

namespace biopsy::safety {

// Nobody requests a stop or takes an image; nothing is known to be absent.
struct Situation : SupervisorInputs {
  Situation() {
    stop = StopCategory::None;
    acquiring = false;
  }
  Evidence evidence;
};

inline std::pair<SupervisorState, SupervisorOutput> step(const PlanFacts& plan, const SupervisorState& state,
                                                         const Situation& situation) {
  return step(plan, state, situation, situation.evidence);
}

// All that a step needs to go on: no hazard, 5 kV on the stack, any rise allowed.
inline Situation healthy() {
  Situation input;
  input.now_us = 123'456;
  input.evidence = {kAllHazards, true, true, true, false, false, false, true, false, 1, 5'000'000, 8'000'000};
  input.self_test = SelfTest::Passed;
  input.accepted_session = 3, input.accepted_since_seq = 65;
  return input;
}

inline SupervisorState in(Mode mode) {
  SupervisorState state = started(3);
  state.mode = mode;
  state.token = 10;
  state.held_mV = 5'000'000;
  state.epoch = 4, state.seq = 70, state.arrived_seq = 60;
  state.arm_was_down = state.reset_was_down = false;
  return state;
}

// One step of the three-step plan, everything healthy; a test changes what it is about.
struct Moment {
  PlanFacts plan = three_step_plan();
  SupervisorState state;
  Situation input = healthy();

  explicit Moment(Mode mode) : state(in(mode)) { input.evidence.zero_volts = mode != Mode::Retract; }
  Moment(Mode mode, std::uint32_t token, bool held) : Moment(mode) { input.motion = {token, held}; }
  SupervisorState next() const { return step(plan, state, input).first; }
  SupervisorOutput output() const { return step(plan, state, input).second; }
  Event event() const { return output().event; }
  Refusal refusal() const { return output().refusal; }
  Permit permit() const { return output().permit; }
  Mode mode() const { return next().mode; }
};

}  // namespace biopsy::safety
