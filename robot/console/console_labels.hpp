// What the console says to a person: every refusal and alarm with its code, what it is, what the robot did
// and what to do now. The codes: E-1nn what a person asked for, E-2nn the hazards of safety/types/hazards.hpp
// by their number.
#pragma once

#include <string>

#include "robot/cycle/run_cycle.hpp"

namespace biopsy::robot {

// E-1nn, in the order of the list.
enum class Refused : std::uint8_t {
  NotController,  // another page controls
  NoSeries,       // nothing is open
  WrongPlace,     // the point does not agree
  NeedleInUse,    // points and plan stay while high voltage is on
  OldPlan,        // the page shows another plan
  NoPlan,         // there is none
  NotNow,         // the button is disabled, and says why
  TokenSpent,     // a press that was used or is over
  OnlyOnDevice,   // a key on the device does it
  NotUnderstood,  // the message breaks the IDL
};

// `why` says more where the list cannot; empty: nothing.
console::events::Answer refusal(std::uint32_t id, Refused reason, const std::string& why = {});

// Whether nothing is wrong but that a plan, or its confirmations, are missing.
bool waits_for_plan(safety::Hazard worst);

// What the supervisor has to say in this tick, worst first; empty: nothing.
std::vector<console::events::Alarm> alarms_of(const CycleRecord& tick, bool stopped_by_person);
console::events::Alarm silence_alarm();

}  // namespace biopsy::robot
