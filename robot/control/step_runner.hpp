// Runs a sealed plan, one control tick at a time: rate-limited setpoint, PI loop, square wave. The result is
// a request; the gate decides what reaches the stack.
#pragma once

#include <cstdint>

#include "robot/control/needle_lock.hpp"
#include "robot/control/pi_loop.hpp"
#include "robot/msg/fixed_messages.hpp"
#include "robot/msg/plan.hpp"

namespace biopsy::control {

// Depth error below which a step counts as settled: the loop's share of the allowed 0.1 mm. Paper IV.F: 0.051
// mm rms.
inline constexpr Millimetres kSettled{0.05};

// The error is judged by its mean over some 64 ms, which leaves 2.4 um of the noise of a laser of 27 um
// (III.D's class). No single reading may be further away than kSettled and six standard deviations of that
// noise: a needle that oscillates about the depth has not settled there.
inline constexpr double kMeanShare = 1.0 / 64.0;
inline constexpr Millimetres kReadingOff{0.21};
// The mean stays within this during the dwell: a needle that friction held beyond its depth and that now
// slides back through it would go on sliding in the hold, where the drive may not rise.
inline constexpr Millimetres kStandsStill{0.015};

struct RunnerState {
  PiState loop;
  Millimetres setpoint;
  std::uint32_t seq = 0;
  std::uint32_t drive_ticks = 0;  // since enabled: phase of the square wave
  std::uint32_t step = 0;
  Millimetres mean_error;           // of the step's depth less the needle's
  Millimetres settled_at;           // mean error when the present dwell began
  std::uint32_t settled_ticks = 0;  // consecutive
  bool raising = false;             // the last permit allowed |V| to rise
  bool reached = false;             // latched until the step changes
  NeedleLock lock;
};

struct RunnerStep {
  RunnerState state;
  DriveRequest request;
};

// What the operator and the supervisor want of the controller.
struct Task {
  std::uint32_t step = 0;   // index of the step that the supervisor selected
  bool hold_still = false;  // for an image: lock the needle in the hold
  bool finish = false;      // requests the retraction
};

RunnerStep run_steps(const Plan& plan, RunnerState state, const Measurement& measurement,
                     const Permit& permit, const Task& task);

}  // namespace biopsy::control
