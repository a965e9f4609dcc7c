// The state machine as a table {from, event, to}; an event that is not in the table changes nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "robot/msg/fixed_messages.hpp"

namespace biopsy::safety {

enum class Event : std::uint8_t {
  None,
  Lockout,         // residual charge or a needle that did not return; self-test failed or took too long
  Fault,           // C0
  VoltagePresent,  // V != 0 where it must be 0
  RampTooLong,     // V != 0 after the time of a C1 ramp
  Ramp,            // C1, requested or needed
  Finished,        // the controller is done with the plan
  HoldTooLong,
  Stop,  // C2, requested or needed; button released
  StepReached,
  Unhealthy,
  ArmedTooLong,
  SelfTestPassed,
  Healthy,  // all hazards absent and the plan sealed
  Arm,
  Move,
  VoltageGone,
  Reset,
};
inline constexpr std::size_t kEvents = static_cast<std::size_t>(Event::Reset) + 1;
inline constexpr std::size_t kModes = static_cast<std::size_t>(Mode::Lock) + 1;

struct Transition {
  Mode from;
  Event event;
  Mode to;
};

inline constexpr std::array kTransitions{
    Transition{Mode::Boot, Event::Lockout, Mode::Lock},
    Transition{Mode::Boot, Event::SelfTestPassed, Mode::Safe},
    Transition{Mode::Safe, Event::Lockout, Mode::Lock},
    Transition{Mode::Safe, Event::VoltagePresent, Mode::Trip},
    Transition{Mode::Safe, Event::Healthy, Mode::Ready},
    Transition{Mode::Ready, Event::Lockout, Mode::Lock},
    Transition{Mode::Ready, Event::VoltagePresent, Mode::Trip},
    Transition{Mode::Ready, Event::Unhealthy, Mode::Safe},
    Transition{Mode::Ready, Event::Stop, Mode::Safe},
    Transition{Mode::Ready, Event::Arm, Mode::Armed},
    Transition{Mode::Armed, Event::Fault, Mode::Trip},
    Transition{Mode::Armed, Event::VoltagePresent, Mode::Trip},
    Transition{Mode::Armed, Event::Ramp, Mode::Ready},
    Transition{Mode::Armed, Event::Stop, Mode::Ready},
    Transition{Mode::Armed, Event::ArmedTooLong, Mode::Ready},
    Transition{Mode::Armed, Event::Move, Mode::Active},
    Transition{Mode::Active, Event::Fault, Mode::Trip},
    Transition{Mode::Active, Event::Ramp, Mode::Retract},
    Transition{Mode::Active, Event::Finished, Mode::Retract},
    Transition{Mode::Active, Event::Stop, Mode::Hold},
    Transition{Mode::Active, Event::StepReached, Mode::Hold},
    Transition{Mode::Hold, Event::Fault, Mode::Trip},
    Transition{Mode::Hold, Event::Ramp, Mode::Retract},
    Transition{Mode::Hold, Event::Finished, Mode::Retract},
    Transition{Mode::Hold, Event::HoldTooLong, Mode::Retract},
    Transition{Mode::Hold, Event::Move, Mode::Active},
    Transition{Mode::Retract, Event::Fault, Mode::Trip},
    Transition{Mode::Retract, Event::RampTooLong, Mode::Trip},
    Transition{Mode::Retract, Event::VoltageGone, Mode::Safe},
    Transition{Mode::Trip, Event::Lockout, Mode::Lock},
    Transition{Mode::Trip, Event::Reset, Mode::Safe},
};

// The mode after an event; an event the table does not know in this mode changes nothing.
constexpr Mode next_mode(Mode from, Event event) {
  for (const Transition& row : kTransitions)
    if (row.from == from && row.event == event) return row.to;
  return from;
}

// The drive may carry voltage in these.
constexpr bool hv_permitted(Mode mode) {
  return mode == Mode::Armed || mode == Mode::Active || mode == Mode::Hold || mode == Mode::Retract;
}

std::string_view name_of(Mode mode);
std::string_view name_of(Event event);

}  // namespace biopsy::safety
