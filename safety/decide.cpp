#include "safety/decide.hpp"

#include <algorithm>

#include "safety/monitors/clock_step.hpp"
#include "safety/types/limits.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::safety {
namespace {

constexpr HazardSet kLocking = locking_hazards();
constexpr HazardSet kC0 = hazards_with(StopCategory::C0Off);
constexpr HazardSet kC1 = hazards_with(StopCategory::C1Ramp);

constexpr StopCategory needed_stop(HazardSet hazards) {
  if ((hazards & kC0) != 0) return StopCategory::C0Off;
  if ((hazards & kC1) != 0) return StopCategory::C1Ramp;
  if (hazards != 0) return StopCategory::C2Hold;
  return StopCategory::None;
}

// Counted no further than anything compares it with.
constexpr std::int32_t longest_ms(Mode mode) {
  return mode == Mode::Hold ? limits::kHoldMax_ms - 1 : limits::kArmedMax_ms;
}

bool is_locked_out(const TransitionInputs& t) {
  return (t.hazards & kLocking) != 0;
}

// The depth check of this step says Accept, for an image that was begun after the needle arrived, and not
// later than now. Numbers of permits rise within a session, so that an image of an earlier epoch is older
// than the arrival.
bool is_accepted(const TransitionInputs& t) {
  const bool of_this_hold = t.input.accepted_session == t.state.session && t.state.arrived_seq != 0 &&
                            t.input.accepted_since_seq >= t.state.arrived_seq &&
                            t.input.accepted_since_seq <= t.state.seq;
  return t.input.depth_accepted && t.input.accepted_step == t.state.step && of_this_hold;
}

// Whether the needle may advance: within a step always, past its end only with the depth check that the plan
// requires.
Refusal refusal_to_go_on(const TransitionInputs& t) {
  if (t.input.acquiring) return Refusal::ImageRunning;  // the drive would switch in it
  if (t.stop != StopCategory::None) return Refusal::Unhealthy;
  if (!t.state.step_done) return Refusal::None;
  const std::uint32_t steps = std::min<std::uint32_t>(t.plan.step_count, kMaxSteps);
  if (steps == 0 || t.state.step >= steps - 1) return Refusal::PlanDone;
  if (!t.plan.steps[t.state.step].image_confirms) return Refusal::None;
  return is_accepted(t) ? Refusal::None : Refusal::DepthNotAccepted;
}

// The button of the present motion was let go, another was pressed, or the console fell silent.
bool is_released(const TransitionInputs& t) {
  const MotionPress& motion = t.input.motion;
  const bool let_go = motion.token == t.state.token && motion.token != 0 && !motion.held;
  return let_go || motion.token > t.state.token || t.state.ms_since_held >= kHeldTimeout_ms;
}

bool is_step_reached(const TransitionInputs& t) {
  return t.input.request.step_reached && t.input.request.step == t.state.step;
}

Event event_in_boot(const TransitionInputs& t) {
  if (is_locked_out(t)) return Event::Lockout;
  if (t.input.self_test == SelfTest::Failed) return Event::Lockout;
  if (t.ms >= kBootMax_ms) return Event::Lockout;
  const bool passed = t.input.self_test == SelfTest::Passed && t.evidence.interlock_opens;
  if (passed && t.evidence.zero_volts) return Event::SelfTestPassed;
  return Event::None;
}

// Friction may hold a needle short of its place: a patient's is drawn back by hand before it is ready again.
bool is_needle_back(const TransitionInputs& t) {
  return t.evidence.needle_back || !is_for_patient(t.plan);
}

Event event_in_safe(const TransitionInputs& t) {
  if (is_locked_out(t)) return Event::Lockout;
  if (!t.evidence.zero_volts) return Event::VoltagePresent;
  if (t.stop == StopCategory::None && is_needle_back(t)) return Event::Healthy;
  return Event::None;
}

Event event_in_ready(const TransitionInputs& t) {
  if (is_locked_out(t)) return Event::Lockout;
  if (!t.evidence.zero_volts) return Event::VoltagePresent;
  if (t.hazards != 0 || !is_needle_back(t)) return Event::Unhealthy;
  if (t.stop != StopCategory::None) return Event::Stop;
  if (t.arm_edge) return Event::Arm;
  return Event::None;
}

Event event_in_armed(const TransitionInputs& t) {
  if (t.stop == StopCategory::C0Off) return Event::Fault;
  if (!t.evidence.zero_volts) return Event::VoltagePresent;
  if (t.stop == StopCategory::C1Ramp) return Event::Ramp;
  if (t.stop == StopCategory::C2Hold) return Event::Stop;
  if (t.ms >= limits::kArmedMax_ms) return Event::ArmedTooLong;
  if (t.pressed && !t.input.acquiring) return Event::Move;
  return Event::None;
}

Event event_in_active(const TransitionInputs& t) {
  if (t.stop == StopCategory::C0Off) return Event::Fault;
  if (t.stop == StopCategory::C1Ramp) return Event::Ramp;
  if (t.input.request.finished) return Event::Finished;
  if (is_step_reached(t)) return Event::StepReached;
  if (t.stop == StopCategory::C2Hold) return Event::Stop;
  if (is_released(t)) return Event::Stop;
  return Event::None;
}

// A locked needle at 0 V does not drift: it may stay as long as a scan, while nothing is wrong.
Event event_in_hold(const TransitionInputs& t) {
  if (t.stop == StopCategory::C0Off) return Event::Fault;
  if (t.stop == StopCategory::C1Ramp) return Event::Ramp;
  if (t.input.request.finished) return Event::Finished;
  const bool may_stay = t.evidence.still && t.stop == StopCategory::None;
  if (t.ms >= limits::kHoldMax_ms && !may_stay) return Event::HoldTooLong;
  if (t.pressed && refusal_to_go_on(t) == Refusal::None) return Event::Move;
  return Event::None;
}

Event event_in_retract(const TransitionInputs& t) {
  if (t.stop == StopCategory::C0Off) return Event::Fault;
  if (t.evidence.zero_volts) return Event::VoltageGone;
  if (t.ms >= limits::kRampTime_ms) return Event::RampTooLong;
  return Event::None;
}

Refusal refusal_to_reset(const TransitionInputs& t) {
  if (t.state.mode != Mode::Trip) return Refusal::NotTripped;
  if (!t.evidence.zero_volts) return Refusal::VoltageLeft;
  if (!t.evidence.needle_home) return Refusal::NeedleOut;
  if (t.stop != StopCategory::None) return Refusal::Unhealthy;
  return Refusal::None;
}

Event event_in_trip(const TransitionInputs& t) {
  if (is_locked_out(t)) return Event::Lockout;
  if (t.reset_edge && refusal_to_reset(t) == Refusal::None) return Event::Reset;
  return Event::None;
}

Refusal refusal_to_arm(const TransitionInputs& t) {
  if (t.stop != StopCategory::None) return Refusal::Unhealthy;
  const bool ready = t.state.mode == Mode::Ready;  // and not armed: something came in this very tick
  if (ready && !t.evidence.zero_volts) return Refusal::VoltageLeft;
  if ((ready || t.state.mode == Mode::Safe) && !is_needle_back(t)) return Refusal::NeedleOut;
  return Refusal::NotReady;
}

// Of a press that was not followed.
Refusal refusal_to_move(const TransitionInputs& t) {
  if (t.state.mode != Mode::Armed && t.state.mode != Mode::Hold) return Refusal::NotArmed;
  if (!t.pressed) return Refusal::TokenSpent;
  const Refusal refusal = refusal_to_go_on(t);
  return refusal == Refusal::None ? Refusal::NotArmed : refusal;  // the mode ends in this very tick
}

}  // namespace

TransitionInputs transition_inputs(const PlanFacts& plan, const SupervisorState& state,
                                   const SupervisorInputs& input, const Evidence& evidence) {
  const HazardSet hazards = evidence.hazards();
  return {plan,
          state,
          input,
          evidence,
          hazards,
          std::min(std::max(input.stop, needed_stop(hazards)), StopCategory::C0Off),
          later_ms(state.ms_in_mode, evidence.elapsed_ms, longest_ms(state.mode) + 1),
          input.motion.held && input.motion.token > state.token,
          input.local_arm && !state.arm_was_down,
          input.local_reset && !state.reset_was_down};
}

Event event_of(const TransitionInputs& t) {
  switch (t.state.mode) {
    case Mode::Boot:
      return event_in_boot(t);
    case Mode::Safe:
      return event_in_safe(t);
    case Mode::Ready:
      return event_in_ready(t);
    case Mode::Armed:
      return event_in_armed(t);
    case Mode::Active:
      return event_in_active(t);
    case Mode::Hold:
      return event_in_hold(t);
    case Mode::Retract:
      return event_in_retract(t);
    case Mode::Trip:
      return event_in_trip(t);
    case Mode::Lock:
      return Event::None;
  }
  return Event::Fault;
}

// Answers the requests of this tick, those that matter most first.
Refusal refusal_of(const TransitionInputs& t, Event event) {
  const bool heartbeat = t.state.mode == Mode::Active && t.input.motion.token <= t.state.token;
  const bool press = t.input.motion.held && t.input.motion.token != 0 && !heartbeat;
  const bool remote = t.input.remote_arm || t.input.remote_reset;
  if (event == Event::Reset || event == Event::Arm || event == Event::Move) return Refusal::None;
  if (t.state.mode == Mode::Lock && (t.reset_edge || t.arm_edge || press || remote)) return Refusal::Locked;
  if (remote) return Refusal::OnlyLocal;
  const bool resets_estop = t.evidence.estop_reset && t.state.mode != Mode::Trip;
  if (t.reset_edge && !resets_estop) return refusal_to_reset(t);
  if (t.arm_edge) return refusal_to_arm(t);
  if (press) return refusal_to_move(t);
  return Refusal::None;
}

std::string_view name_of(Refusal refusal) {
  switch (refusal) {
    case Refusal::None:
      return "none";
    case Refusal::Locked:
      return "locked: restart and service only";
    case Refusal::OnlyLocal:
      return "arm and reset only work on the device itself";
    case Refusal::NotTripped:
      return "nothing to reset";
    case Refusal::VoltageLeft:
      return "voltage is not zero";
    case Refusal::NeedleOut:
      return "needle has not returned";
    case Refusal::Unhealthy:
      return "a hazard or a stop is present";
    case Refusal::NotReady:
      return "not ready";
    case Refusal::NotArmed:
      return "not armed";
    case Refusal::TokenSpent:
      return "release the button and press again";
    case Refusal::DepthNotAccepted:
      return "the depth check of this step has not been accepted";
    case Refusal::PlanDone:
      return "the plan has no further step";
    case Refusal::ImageRunning:
      return "an image is being taken";
  }
  return "unknown refusal";
}

}  // namespace biopsy::safety
