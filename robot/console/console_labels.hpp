// Refusals and alarms of the console: code, what happened, what the robot did and what to do now. Codes:
// E-1nn refused commands, E-2nn the hazards of safety/types/hazards.hpp by their number.
#pragma once

#include <string>

#include "robot/cycle/run_cycle.hpp"
#include "robot/msg/console_messages.hpp"

namespace biopsy::robot {

// E-1nn, in the order of the list.
enum class Refused : std::uint8_t {
  NotController,  // another page controls
  NoSeries,       // nothing is open
  WrongPlace,     // page and server disagree on the point
  NeedleInUse,    // points and plan stay while high voltage is on
  OldPlan,        // the page shows another plan
  NoPlan,         // there is none
  NotNow,         // the button is disabled, and says why
  TokenUsed,      // of a press that was used or is over
  OnlyOnDevice,   // needs a key on the device
  Malformed,      // the message violates the IDL
};

// `why` is added to the text; empty: nothing.
console::events::Answer refusal(std::uint32_t id, Refused reason, const std::string& why = {});

// Whether only a plan or its confirmations are missing.
bool waits_for_plan(safety::Hazard worst);

// Alarms of this tick, most severe first. `shown_um`: the depth as the page shows it.
std::vector<console::events::Alarm> alarms_of(const CycleRecord& tick, std::int32_t shown_um,
                                              bool stopped_by_operator);
// STOP without high voltage, until Reset.
console::events::Alarm standing_stop_alarm();
console::events::Alarm silence_alarm();
// Notices of what a navigation program wishes.
console::events::Alarm proposal_notice();
console::events::Alarm motion_notice();
console::events::Alarm navigation_stop_notice();

}  // namespace biopsy::robot
