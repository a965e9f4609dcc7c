// The paper's controller, eq. (22): |u_i| = K_p e + K_i sum(e), on a 1 ms tick, with anti-windup at the
// permit's envelope and nothing else.
#pragma once

#include "robot/common/units.hpp"
#include "robot/msg/plan.hpp"

namespace biopsy::control {

struct PiState {
  Volts integral;
  Volts amplitude;  // put out last
};

// The next amplitude in [0, envelope] for the error target - measured. The integral moves only while the
// amplitude is inside its bounds, or while it moves back towards them.
PiState pi_step(const PiGains& gains, PiState state, Millimetres error, Volts envelope);

// Takes over from a held amplitude without a bump: the integral that would have given it at this error.
PiState pi_resume(const PiGains& gains, Volts held, Millimetres error);

}  // namespace biopsy::control
