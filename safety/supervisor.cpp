#include "safety/supervisor.hpp"

#include <algorithm>

#include "safety/challenge.hpp"
#include "safety/decide.hpp"
#include "safety/monitors/clock_step.hpp"
#include "safety/types/limits.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::safety {
namespace {

// {from, event} -> to, unfolded from the table at compile time.
constexpr auto kNext = [] {
  std::array<std::array<Mode, kEvents>, kModes> next{};
  for (std::size_t from = 0; from < kModes; ++from)
    for (std::size_t event = 0; event < kEvents; ++event)
      next[from][event] = next_mode(static_cast<Mode>(from), static_cast<Event>(event));
  return next;
}();

StepLimits step_limits(const PlanFacts& plan, std::uint32_t step) {
  if (step >= plan.step_count || step >= kMaxSteps) return {};
  StepLimits allowed = plan.steps[step];
  allowed.depth_max_um = std::min(allowed.depth_max_um, plan.depth_max_um);
  allowed.v_max_mV = std::clamp(allowed.v_max_mV, 0, limits::kDriveMax_mV);
  allowed.slew_up_mV_per_tick = std::clamp(allowed.slew_up_mV_per_tick, 0, limits::kSlewUpMax_mV_per_tick);
  return allowed;
}

// How far |V| may rise in this tick.
std::int32_t rising_mV(const PlanFacts& plan, const SupervisorState& state, const Evidence& evidence) {
  return std::clamp(evidence.ceiling_mV, 0, step_limits(plan, state.step).v_max_mV);
}

// |V| when Hold or Retract began, within the limits of the robot whatever the state holds.
std::int32_t held_mV(const SupervisorState& state) {
  return std::clamp(state.held_mV, 0, limits::kDriveMax_mV);
}

// The cause to report. Without a measurement voltage counts as present: the cause is then the missing
// measurement, and not another hazard that is present as well, such as a missing plan.
Hazard cause_of(const TransitionInputs& t, Event event) {
  const bool unseen = event == Event::VoltagePresent && (t.hazards & bit(Hazard::SensorStale)) != 0;
  return unseen ? Hazard::SensorStale : worst_of(t.hazards);
}

// Effects of a change of mode on the plan's progress and on the envelope.
void enter(SupervisorState& next, const TransitionInputs& t, Event event) {
  const Mode from = t.state.mode;
  next.last_event = event;
  if (event != Event::VoltageGone) next.reason = cause_of(t, event);  // the end of a ramp keeps its cause
  next.ms_in_mode = 0;
  if (next.mode == Mode::Trip || next.mode == Mode::Lock) ++next.epoch;
  if (next.mode == Mode::Armed) next.step = 0, next.step_done = false;
  if (event == Event::StepReached) next.step_done = true, next.arrived_seq = next.seq;
  if (event == Event::Move && t.state.step_done) ++next.step, next.step_done = false;
  const std::int32_t envelope =
      from == Mode::Active ? rising_mV(t.plan, t.state, t.evidence) : held_mV(t.state);
  if (next.mode == Mode::Hold || next.mode == Mode::Retract)
    next.held_mV = std::clamp(t.evidence.drive_mV, 0, envelope);
}

// A mode that does not exist is a broken memory: nothing is allowed any more.
Mode mode_after(Mode from, Event event) {
  return from <= Mode::Lock ? kNext[static_cast<std::size_t>(from)][static_cast<std::size_t>(event)]
                            : Mode::Lock;
}

// `next` comes in as a copy of the state.
void advance(SupervisorState& next, const TransitionInputs& t, Event event) {
  next.mode = mode_after(t.state.mode, event);
  next.ms_in_mode = t.ms;
  next.seq = t.state.seq + 1;
  next.token = std::max(t.state.token, t.input.motion.token);
  next.arm_was_down = t.input.local_arm;
  next.reset_was_down = t.input.local_reset;
  const bool renewed =
      t.input.motion.held && t.input.motion.token >= t.state.token && t.input.motion.token != 0;
  next.ms_since_held = renewed ? 0 : later_ms(t.state.ms_since_held, t.evidence.elapsed_ms, kHeldTimeout_ms);
  if (next.mode != t.state.mode) enter(next, t, event);
}

std::int32_t ramp_mV(const SupervisorState& state) {
  const std::int64_t left = kRamp_ms - std::clamp(state.ms_in_mode, 0, kRamp_ms);
  return static_cast<std::int32_t>(held_mV(state) * left / kRamp_ms);
}

void allow_step(Permit& permit, const StepLimits& allowed) {
  permit.slew_up_mV_per_tick = allowed.slew_up_mV_per_tick;
  permit.depth_max_um = allowed.depth_max_um;
}

// `permit` comes in off: no enable, no voltage, no rise.
void fill_permit(Permit& permit, const PlanFacts& plan, const SupervisorState& state,
                 const SupervisorInputs& inputs, const Evidence& evidence) {
  permit.session = state.session;
  permit.epoch = state.epoch;
  permit.seq = state.seq;
  permit.issued_us = inputs.now_us;
  permit.ttl_us = limits::kPermitTtl_us;
  permit.mode = state.mode;
  permit.hv_enable = hv_permitted(state.mode);
  permit.plan_tag = plan.plan_tag;
  permit.config_tag = plan.config_tag;
  permit.challenge = challenge_of(state.session, state.seq);
  // Taken at a step's end only; then kept until the drive carries the needle again.
  const bool arrived = state.mode == Mode::Hold && state.step_done;
  permit.brake = (arrived && inputs.measurement.brake_fitted) ||
                 (evidence.locked && (state.mode == Mode::Active || state.mode == Mode::Hold));
  switch (state.mode) {
    case Mode::Armed:
      permit.stop = StopCategory::C2Hold;
      break;
    case Mode::Active:
      permit.stop = StopCategory::None;
      permit.v_max_mV = rising_mV(plan, state, evidence);
      allow_step(permit, step_limits(plan, state.step));
      break;
    case Mode::Hold:
      permit.stop = StopCategory::C2Hold;
      permit.v_max_mV = held_mV(state);
      break;
    case Mode::Retract:
      permit.stop = StopCategory::C1Ramp;
      permit.v_max_mV = ramp_mV(state);
      break;
    default:  // every other mode: nothing is allowed
      break;
  }
}

}  // namespace

std::pair<SupervisorState, SupervisorOutput> step(const PlanFacts& plan, const SupervisorState& state,
                                                  const SupervisorInputs& inputs, const Evidence& evidence) {
  const TransitionInputs tick = transition_inputs(plan, state, inputs, evidence);
  const Event event = event_of(tick);
  // Filled in where the caller gets it: to copy what was just written in parts takes as long as to decide it.
  std::pair<SupervisorState, SupervisorOutput> result;
  auto& [next, output] = result;
  next = state;
  advance(next, tick, event);
  fill_permit(output.permit, plan, next, inputs, evidence);
  output.event = event;
  output.worst = worst_of(tick.hazards);
  output.reason = next.reason;
  output.refusal = refusal_of(tick, event);
  output.step = next.step;
  output.step_done = next.step_done;
  output.image_allowed = next.mode != Mode::Active && next.mode != Mode::Retract;
  output.image_disturbed = evidence.image_disturbed;
  output.interlock_pulse = hv_permitted(next.mode) || next.mode == Mode::Ready || next.mode == Mode::Boot;
  return result;
}

}  // namespace biopsy::safety
