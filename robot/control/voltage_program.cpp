#include "robot/control/voltage_program.hpp"

#include <algorithm>

namespace biopsy::control {
namespace {

int sign_at(const VoltageProgram& program, std::uint32_t tick) {
  const bool turned = program.half_period_ticks > 0 && tick / program.half_period_ticks % 2 == 1;
  return turned ? -program.sign : program.sign;
}

bool goes_on(const VoltageProgram& program, const ProgramState& state, Mode mode) {
  const bool holding = mode == Mode::Hold && state.ticks >= program.hold_from_tick;
  return mode == Mode::Active || holding;
}

}  // namespace

std::uint32_t length_ticks(const VoltageProgram& program) {
  std::uint32_t ticks = 0;
  for (const VoltageSegment& segment : program.segments) ticks += segment.ticks;
  return ticks;
}

Volts highest(const VoltageProgram& program) {
  Volts most;
  for (const VoltageSegment& segment : program.segments) most = std::max({most, segment.from, segment.to});
  return most;
}

Volts amplitude_at(const VoltageProgram& program, std::uint32_t tick) {
  for (const VoltageSegment& segment : program.segments) {
    if (tick < segment.ticks)
      return segment.from + (static_cast<double>(tick) / segment.ticks) * (segment.to - segment.from);
    tick -= segment.ticks;
  }
  return {};
}

bool is_played(const VoltageProgram& program, const ProgramState& state) {
  return state.ticks >= length_ticks(program);
}

ProgramStep play(const VoltageProgram& program, ProgramState state, const Permit& permit, bool finish) {
  DriveRequest request;
  request.seq = ++state.seq;
  if (!permit.hv_enable) {
    ProgramState idle;
    idle.seq = state.seq;
    return {idle, request};
  }
  if (goes_on(program, state, permit.mode)) {
    state.amplitude = amplitude_at(program, state.ticks);
    state.ticks = std::min(state.ticks + 1, length_ticks(program));
  }
  state.amplitude = std::min(state.amplitude, std::max(Volts(0), from_mV(permit.v_max_mV)));
  if (permit.mode != Mode::Armed) request.wanted_mV = sign_at(program, state.wave++) * to_mV(state.amplitude);
  request.step_reached = state.ticks >= program.hold_from_tick;
  request.finished = finish || is_played(program, state);
  return {state, request};
}

}  // namespace biopsy::control
