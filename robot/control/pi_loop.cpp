#include "robot/control/pi_loop.hpp"

#include <algorithm>

namespace biopsy::control {

PiState pi_step(const PiGains& gains, PiState state, Millimetres error, Volts envelope) {
  const Volts step(gains.integral_V_per_mm_per_tick * error.value);
  const Volts wanted = Volts(gains.proportional_V_per_mm * error.value) + state.integral + step;
  const bool pushes_out = (wanted > envelope && step > Volts(0)) || (wanted < Volts(0) && step < Volts(0));
  if (!pushes_out) state.integral += step;
  state.amplitude = std::clamp(wanted, Volts(0), std::max(Volts(0), envelope));
  return state;
}

PiState pi_resume(const PiGains& gains, Volts held, Millimetres error) {
  return {.integral = held - Volts(gains.proportional_V_per_mm * error.value), .amplitude = held};
}

}  // namespace biopsy::control
