#include "robot/control/step_runner.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "robot/control/square_wave.hpp"

namespace biopsy::control {
namespace {

constexpr Millimetres kReturnBand{0.09};  // kSettled and four standard deviations of the laser

// Depth of the needle while nothing drives it: where the setpoint starts from.
RunnerState at_rest(RunnerState state, Millimetres depth) {
  state.loop = {};
  state.setpoint = std::max(Millimetres(0), depth);
  state.drive_ticks = 0;
  state.raising = false;
  return state;
}

RunnerState enter_stage(RunnerState state, std::uint32_t stage) {
  if (stage == state.stage) return state;
  state.stage = stage;
  state.settled_ticks = 0;
  state.reached = false;
  return state;
}

// The setpoint moves to the step's depth at the step's speed, never beyond.
Millimetres advanced(Millimetres from, const InsertionStep& stage) {
  const Millimetres stride = stage.speed * Seconds(kTick);
  return from + std::clamp(stage.depth - from, -stride, stride);
}

RunnerState judge(RunnerState state, const InsertionStep& stage, Millimetres depth) {
  const bool settled = std::abs((stage.depth - depth).value) <= kSettled.value;
  state.settled_ticks = settled ? state.settled_ticks + 1 : 0;
  if (state.settled_ticks * Seconds(kTick) >= stage.dwell) state.reached = true;
  return state;
}

// In a hold the amplitude is constant: regulation could only lower it, by each sample's noise a little
// further. A needle that jumped beyond its step is regulated back.
RunnerState held(const PiGains& gains, RunnerState state, const InsertionStep& stage, Millimetres depth,
                 Volts envelope) {
  const Volts ceiling = std::min(state.loop.amplitude, envelope);
  if (depth > stage.depth + kReturnBand)
    state.loop = pi_step(gains, state.loop, stage.depth - depth, ceiling);
  else
    state.loop.amplitude = ceiling;
  state.raising = false;
  return state;
}

}  // namespace

RunnerStep run_stage(const Plan& plan, const PiGains& gains, RunnerState state,
                     const Measurement& measurement, const Permit& permit, std::uint32_t stage_index,
                     bool finish) {
  assert(stage_index < plan.stages.size());
  const InsertionStep& stage = plan.stages[stage_index];
  const Millimetres depth = from_um(measurement.depth_um);
  state = enter_stage(state, stage_index);
  if (!permit.hv_enable) {
    state = at_rest(state, depth);
  } else if (permit.slew_up_mV_per_tick <= 0) {
    state = held(gains, state, stage, depth, from_mV(permit.v_max_mV));
  } else {
    if (!state.raising) state.loop = pi_resume(gains, state.loop.amplitude, state.setpoint - depth);
    state.raising = true;
    state.setpoint = advanced(state.setpoint, stage);
    state.loop = pi_step(gains, state.loop, state.setpoint - depth, from_mV(permit.v_max_mV));
    state = judge(state, stage, depth);
  }
  DriveRequest request;
  request.seq = ++state.seq;
  request.wanted_mV = permit.hv_enable ? polarity(state.drive_ticks++) * to_mV(state.loop.amplitude) : 0;
  request.stage = stage_index;
  request.stage_reached = state.reached;
  request.finished = finish;
  request.measured_seq = measurement.seq;
  request.setpoint_um = to_um(state.setpoint);
  return {state, request};
}

}  // namespace biopsy::control
