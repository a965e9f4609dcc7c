// Runs a sealed plan, one control tick at a time: rate-limited setpoint, PI loop, square wave. It only asks;
// what reaches the stack is the gate's doing.
#pragma once

#include <cstdint>

#include "robot/control/pi_loop.hpp"
#include "robot/msg/fixed_messages.hpp"
#include "robot/msg/plan.hpp"

namespace biopsy::control {

// Depth error below which a stage counts as settled, and the share of the 0.1 mm that a biopsy may be off
// which the loop takes for itself. The paper's own figure is 0.051 mm rms (IV.F).
inline constexpr Millimetres kSettled{0.05};

struct RunnerState {
  PiState loop;
  Millimetres setpoint;
  std::uint32_t seq = 0;
  std::uint32_t drive_ticks = 0;  // since enabled: phase of the square wave
  std::uint32_t stage = 0;
  std::uint32_t settled_ticks = 0;  // within kSettled of the stage's depth, without a break
  bool raising = false;             // the last permit allowed a rise
  bool reached = false;             // latched until the stage changes
};

struct RunnerStep {
  RunnerState state;
  DriveRequest request;
};

// `stage`: the stage the supervisor wants driven. `finish`: the operator is done; asks for the retraction.
RunnerStep run_stage(const Plan& plan, const PiGains& gains, RunnerState state,
                     const Measurement& measurement, const Permit& permit, std::uint32_t stage, bool finish);

}  // namespace biopsy::control
