// The supervisor: one pure function from state and evidence to the permit. Integers, injected time, no I/O.
// Call order in a tick: evidence.hpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <utility>

#include "robot/msg/fixed_messages.hpp"
#include "safety/monitors/evidence.hpp"
#include "safety/types/plan_facts.hpp"
#include "safety/types/supervisor_inputs.hpp"
#include "safety/types/thresholds.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::safety {

// Why a request of this tick was not followed.
enum class Refusal : std::uint8_t {
  None,
  Locked,
  OnlyLocal,
  NotTripped,
  VoltageLeft,
  NeedleOut,
  Unhealthy,
  NotReady,
  NotArmed,
  TokenSpent,
  DepthNotAccepted,
  PlanDone,
  ImageRunning,
};

struct SupervisorState {
  Mode mode = Mode::Boot;
  Event last_event = Event::None;  // of the last change of mode
  Hazard reason = Hazard::None;    // cause of the last change of mode, kept through the end of a ramp
  bool step_done = false;          // the controller reached the present step
  bool arm_was_down = true, reset_was_down = true;  // a key held since before the start is not an edge
  std::uint32_t session = 0, epoch = 1, seq = 0;
  std::uint32_t token = 0;  // largest token ever seen: spent
  std::uint32_t step = 0;
  std::uint32_t arrived_seq = 0;  // of the permit with which the step was reached
  std::int32_t ms_in_mode = 0;    // on the supervisor's clock
  std::int32_t ms_since_held = 0;
  std::int32_t held_mV = 0;  // |V| when Hold or Retract began
};

struct SupervisorOutput {
  Permit permit;
  Event event = Event::None;     // what changed the mode in this tick
  Hazard worst = Hazard::None;   // worst hazard present
  Hazard reason = Hazard::None;  // SupervisorState::reason
  Refusal refusal =
      Refusal::Locked;           // answer to a request of this tick; None if it was followed or none was made
  std::uint32_t step = 0;        // the step the controller is to drive
  bool step_done = false;        // Hold at a step's end: waits for the depth check and a new press
  bool image_allowed = false;    // a scan may start: the drive is not rising
  bool image_disturbed = true;   // the image being taken saw the drive switch: repeat it
  bool interlock_pulse = false;  // feed the hardware interlock this tick; never fed when stopped
};

// `session` is larger at every start of the supervisor (seconds since 1970 will do), never 0.
constexpr SupervisorState started(std::uint32_t session) {
  SupervisorState state;
  state.session = session;
  return state;
}

// `evidence`: what assess() made of the same inputs.
std::pair<SupervisorState, SupervisorOutput> step(const PlanFacts& plan, const SupervisorState& state,
                                                  const SupervisorInputs& inputs, const Evidence& evidence);

std::string_view name_of(Refusal refusal);

// How much a mode allows, for comparison: Retract only lowers, so it ranks below Safe.
constexpr int permissiveness(Mode mode) {
  constexpr int kRank[] = {2, 4, 5, 7, 8, 6, 3, 1, 0};  // Boot Safe Ready Armed Active Hold Retract Trip Lock
  return kRank[static_cast<int>(mode)];
}

}  // namespace biopsy::safety
