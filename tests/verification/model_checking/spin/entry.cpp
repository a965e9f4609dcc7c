// Between Spin's small state and the shipped step. Written apart from the explorer, so that a mistake in one
// abstraction is not in the other.
#include "entry.h"

#include <algorithm>

#include "safety/supervisor.hpp"
#include "tests/safety/situation.hpp"

using namespace biopsy;

SpinState spin_state;
SpinOutput spin_output;

namespace {

constexpr std::uint32_t kPresent = 7;
constexpr std::int32_t kHeld_mV = 5'000'000;

safety::PlanFacts plan() {
  safety::PlanFacts facts;
  facts.plan_tag = 1;
  facts.config_tag = 2;
  facts.depth_max_um = 4'000;
  facts.step_count = 3;
  facts.steps[0] = {3'600, 6'500'000, 20'000, false};
  facts.steps[1] = {3'800, 7'000'000, 20'000, true};
  facts.steps[2] = {4'000, 7'500'000, 20'000, true};
  return facts;
}
const safety::PlanFacts kPlan = plan();

// The last but one tick of a mode that time ends; 0 where it does not.
std::int32_t late_tick(Mode mode) {
  switch (mode) {
    case Mode::Boot:
    case Mode::Hold:
      return 10'000 - 2;
    case Mode::Armed:
      return 30'000 - 2;
    case Mode::Retract:
      return 300 - 2;
    case Mode::Active:
      return 100 - 1;
    case Mode::Safe:
    case Mode::Ready:
    case Mode::Trip:
    case Mode::Lock:
      break;
  }
  return 0;
}

safety::SupervisorState unpack(const SpinState& packed) {
  safety::SupervisorState state = safety::started(3);
  state.mode = static_cast<Mode>(packed.mode);
  (state.mode == Mode::Active ? state.ms_since_held : state.ms_in_mode) = packed.ticks;
  state.step = packed.step;
  state.step_done = packed.step_done != 0;
  state.arrived_seq = state.seq = 1;
  state.arm_was_down = packed.arm_was_down != 0;
  state.reset_was_down = packed.reset_was_down != 0;
  state.token = packed.any_token != 0 ? kPresent : 0;
  state.held_mV = kHeld_mV;
  return state;
}

SpinState pack(const safety::SupervisorState& state, bool exact) {
  const std::int32_t late = late_tick(state.mode);
  std::int32_t ticks = state.mode == Mode::Active ? state.ms_since_held : state.ms_in_mode;
  if (late == 0) ticks = 0;
  if (!exact && ticks > 1 && ticks < late) ticks = 1;
  const bool keys = state.mode == Mode::Ready || state.mode == Mode::Trip;
  SpinState packed = {};
  packed.ticks = static_cast<unsigned short>(ticks);
  packed.mode = static_cast<unsigned char>(state.mode);
  packed.step = static_cast<unsigned char>(state.step);
  packed.step_done = state.step_done;
  packed.arm_was_down = keys && state.arm_was_down;
  packed.reset_was_down = keys && state.reset_was_down;
  packed.any_token = state.token != 0;
  return packed;
}

safety::Situation unpack(const SpinInput& packed, const safety::SupervisorState& state) {
  constexpr safety::HazardSet kHazard[] = {0, bit(safety::Hazard::PatientMotion),
                                           bit(safety::Hazard::SensorStale), bit(safety::Hazard::Arc),
                                           bit(safety::Hazard::ResidualCharge)};
  const std::uint32_t tokens[] = {0, state.token == 0 ? 0 : kPresent - 1, state.token, state.token + 1};
  safety::Situation input;
  input.evidence.clear = safety::kAllHazards & ~kHazard[packed.hazard];
  input.evidence.zero_volts = packed.zero != 0;
  input.evidence.needle_home = packed.home != 0;
  input.evidence.needle_back = true;
  input.evidence.drive_mV = kHeld_mV;
  input.evidence.ceiling_mV = 8'000'000;
  input.self_test = static_cast<safety::SelfTest>(packed.self_test);
  input.local_arm = packed.arm != 0;
  input.local_reset = packed.reset != 0;
  input.remote_arm = input.remote_reset = packed.remote != 0;
  input.stop = static_cast<StopCategory>(packed.stop);
  input.motion = {tokens[packed.motion / 2], packed.motion % 2 == 1};
  input.request.step = state.step;
  input.request.step_reached = packed.reached != 0;
  input.request.finished = packed.finished != 0;
  input.depth_accepted = packed.depth != 0;
  input.accepted_step = state.step + (packed.depth == 2 ? 1 : 0);
  input.accepted_session = state.session;
  input.accepted_since_seq = state.arrived_seq;
  input.evidence.interlock_opens = true;
  return input;
}

}  // namespace

void spin_start() {
  spin_state = pack(safety::started(3), true);
  spin_output = {};
}

void spin_step(const SpinInput* packed, int exact) {
  safety::SupervisorState before = unpack(spin_state);
  if (packed->jump != 0) {
    std::int32_t& ticks = before.mode == Mode::Active ? before.ms_since_held : before.ms_in_mode;
    ticks = std::max(ticks, late_tick(before.mode));
  }
  const auto [next, output] = safety::step(kPlan, before, unpack(*packed, before));
  spin_output = {};
  spin_output.before = static_cast<unsigned char>(before.mode);
  spin_output.event = static_cast<unsigned char>(output.event);
  spin_output.enabled = output.permit.hv_enable;
  spin_output.may_rise = output.permit.slew_up_mV_per_tick > 0;
  spin_output.stop = static_cast<unsigned char>(output.permit.stop);
  spin_output.epoch_raised = next.epoch == before.epoch + 1;
  spin_output.seq_raised = output.permit.seq == before.seq + 1;
  spin_output.spent = next.token >= before.token;
  spin_output.done_before = before.step_done;
  spin_output.confirms = kPlan.steps[before.step % 3].image_confirms;
  spin_output.step_before = static_cast<unsigned char>(before.step);
  spin_output.v_max_mV = output.permit.v_max_mV;
  spin_output.envelope_before_mV =
      before.mode == Mode::Active ? kPlan.steps[before.step % 3].v_max_mV : kHeld_mV;
  spin_state = pack(next, exact != 0);
}
