// Monitors what can fail unnoticed until it is needed: the contacts of the emergency stop, the reset key, and
// the relay and the two timers of the interlock (latent faults, ISO 14971 and IEC 61508: proof test).
//
// Emergency stop and reset key are tested by a person once in a session: both contacts closed, both open,
// both closed again and the reset key turned, the arm key being open. A press is latched until the reset key
// is turned (ISO 13850, 4.1.4). A key that stays turned is stuck, and the test is void.
//
// The interlock tests itself. In Boot only the supervisor feeds it, in Safe, Trip and Lock only the driver,
// otherwise both: a timer that does not open or a welded relay shows in Boot or Safe, one that does not close
// in Ready.
#pragma once

#include <cstdint>

#include "safety/types/hazards.hpp"
#include "safety/types/supervisor_inputs.hpp"

namespace biopsy::safety {

struct PanelMonitor {
  enum class Test : std::uint8_t { None, Closed, Pressed, Passed };
  Test test = Test::None;  // how far it got
  std::int64_t tested_us = 0;
  std::int64_t keys_open_us = 0;  // when neither key was turned, or voltage was permitted
  bool pressed = false;           // latched
  bool reset_was_down = true;
  std::int32_t differs_ticks = 0;
  bool differed = false;         // until both contacts were seen open together
  std::int32_t relay_ticks = 0;  // for which it was unlike the pulses
  std::int32_t open_ticks = 0;   // in Boot, fed by the supervisor alone
};

struct PanelFindings {
  HazardSet found = 0;
  bool reset = false;            // the reset key was turned in this tick and released the emergency stop
  bool interlock_opens = false;  // on the driver's timer alone
};

// `answers`: the stage answers the permits of this supervisor.
PanelFindings update(PanelMonitor& monitor, const SupervisorInputs& seen, bool answers);

}  // namespace biopsy::safety
