#include "robot/control/step_runner.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "robot/control/square_wave.hpp"

namespace biopsy::control {
namespace {

constexpr Millimetres kReturnBand{0.06};  // of the mean error: kSettled and what the mean leaves of the noise

// Depth of the needle while nothing drives it: where the setpoint starts from.
RunnerState at_rest(RunnerState state, Millimetres depth) {
  state.loop = {};
  state.setpoint = std::max(Millimetres(0), depth);
  state.drive_ticks = 0;
  state.raising = false;
  state.lock = {};
  return state;
}

RunnerState enter_step(RunnerState state, std::uint32_t step) {
  if (step == state.step) return state;
  state.step = step;
  state.settled_ticks = 0;
  state.reached = false;
  return state;
}

// The setpoint moves to the step's depth at the step's speed, never beyond.
Millimetres advanced(Millimetres from, const InsertionStep& step) {
  const Millimetres stride = step.speed * Seconds(kTick);
  return from + std::clamp(step.depth - from, -stride, stride);
}

RunnerState judge(RunnerState state, const InsertionStep& step, Millimetres error) {
  const bool near =
      std::abs(state.mean_error.value) <= kSettled.value && std::abs(error.value) <= kReadingOff.value;
  const bool still = std::abs((state.mean_error - state.settled_at).value) <= kStandsStill.value;
  if (!near || !still) state.settled_at = state.mean_error;
  state.settled_ticks = near && still ? state.settled_ticks + 1 : 0;
  if (state.settled_ticks * Seconds(kTick) >= step.dwell) state.reached = true;
  return state;
}

// In a hold the amplitude is constant: regulation could only lower it, by each sample's noise a little
// further. A needle that jumped beyond its step is regulated back.
RunnerState held(const PiGains& gains, RunnerState state, Millimetres error, Volts envelope) {
  const Volts ceiling = std::min(state.loop.amplitude, envelope);
  if (state.mean_error < -kReturnBand || error < -kReadingOff)
    state.loop = pi_step(gains, state.loop, error, ceiling);
  else
    state.loop.amplitude = ceiling;
  state.raising = false;
  return state;
}

// The setpoint waits where the needle is: one that slipped is brought back at the step's speed.
RunnerState lifted(RunnerState state, Millimetres depth, Volts envelope) {
  state.lock = lift(state.lock, state.loop.amplitude, envelope);
  state.setpoint = std::min(state.setpoint, depth);
  return state;
}

RunnerState driven(const PiGains& gains, RunnerState state, const InsertionStep& step, Millimetres depth,
                   Volts envelope) {
  if (!state.raising) state.loop = pi_resume(gains, state.loop.amplitude, state.setpoint - depth);
  state.raising = true;
  state.setpoint = advanced(state.setpoint, step);
  state.loop = pi_step(gains, state.loop, state.setpoint - depth, envelope);
  return judge(state, step, step.depth - depth);
}

}  // namespace

RunnerStep run_steps(const Plan& plan, RunnerState state, const Measurement& measurement,
                     const Permit& permit, const Task& task) {
  assert(task.step < plan.steps.size());
  const InsertionStep& step = plan.steps[task.step];
  const PiGains& gains = plan.gains;
  const Millimetres depth = from_um(measurement.depth_um), error = step.depth - depth;
  const Volts envelope = from_mV(permit.v_max_mV);
  state = enter_step(state, task.step);
  state.mean_error += kMeanShare * (error - state.mean_error);
  if (!permit.hv_enable) {
    state = at_rest(state, depth);
  } else if (permit.slew_up_mV_per_tick <= 0) {
    if (!state.lock.on) state = held(gains, state, error, envelope);
    state.lock = lock_in_hold(state.lock, permit.brake && measurement.brake_fitted, task.hold_still,
                              state.loop.amplitude);
    state.loop.amplitude = std::min(unloaded(state.lock, state.loop.amplitude), envelope);
  } else if (state.lock.on && permit.brake) {
    state = lifted(state, depth, envelope);
  } else {
    state.lock = {};
    state = driven(gains, state, step, depth, envelope);
  }
  DriveRequest request;
  request.seq = ++state.seq;
  request.wanted_mV = permit.hv_enable ? polarity(state.drive_ticks++) * to_mV(state.loop.amplitude) : 0;
  request.brake = state.lock.on;
  request.step = task.step;
  request.step_reached = state.reached;
  request.finished = task.finish;
  request.measured_seq = measurement.seq;
  request.setpoint_um = to_um(state.setpoint);
  return {state, request};
}

}  // namespace biopsy::control
