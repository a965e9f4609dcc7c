// Open-loop voltage: piecewise linear amplitude, polarity as a square wave or constant (DC). Played one
// control tick at a time; the result is a request, the gate decides what reaches the stack.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "robot/common/units.hpp"
#include "robot/control/square_wave.hpp"
#include "robot/msg/fixed_messages.hpp"

namespace biopsy::control {

// Amplitude from `from` towards `to`, which the following segment begins with.
struct VoltageSegment {
  std::uint32_t ticks = 0;
  Volts from, to;
};

struct VoltageProgram {
  std::vector<VoltageSegment> segments;
  std::uint32_t half_period_ticks = kHalfPeriod_ticks;  // between changes of polarity; 0: of one sign (DC)
  int sign = 1;                                         // +1 or -1: of the first half period
  // From here on the amplitude never rises and a hold is requested: only there the supervisor accepts a
  // constant polarity (10 s at most).
  std::uint32_t hold_from_tick = std::numeric_limits<std::uint32_t>::max();
};

std::uint32_t length_ticks(const VoltageProgram& program);
Volts highest(const VoltageProgram& program);
Volts amplitude_at(const VoltageProgram& program, std::uint32_t tick);  // 0 V after the end

// Starts with the first tick in which the permit allows a rise. Where that ends before the program does, the
// program stops and the amplitude stays within the permit until HV is disabled.
struct ProgramState {
  std::uint32_t seq = 0;
  std::uint32_t ticks = 0;  // of the program played so far
  std::uint32_t wave = 0;   // phase of the polarity; continues where the program stops
  Volts amplitude;          // requested last
};

struct ProgramStep {
  ProgramState state;
  DriveRequest request;
};

bool is_played(const VoltageProgram& program, const ProgramState& state);

// `finish`: requests the ramp to 0 V.
ProgramStep play(const VoltageProgram& program, ProgramState state, const Permit& permit, bool finish);

}  // namespace biopsy::control
