#include "safety/types/transitions.hpp"

namespace biopsy::safety {

std::string_view name_of(Mode mode) {
  switch (mode) {
    case Mode::Boot:
      return "boot";
    case Mode::Safe:
      return "safe";
    case Mode::Ready:
      return "ready";
    case Mode::Armed:
      return "armed";
    case Mode::Active:
      return "active";
    case Mode::Hold:
      return "hold";
    case Mode::Retract:
      return "retract";
    case Mode::Trip:
      return "trip";
    case Mode::Lock:
      return "lock";
  }
  return "unknown mode";
}

std::string_view name_of(Event event) {
  switch (event) {
    case Event::None:
      return "none";
    case Event::Lockout:
      return "locked out";
    case Event::Fault:
      return "fault: immediate stop";
    case Event::VoltagePresent:
      return "voltage present where there must be none";
    case Event::RampTooLong:
      return "voltage did not ramp down in time";
    case Event::Ramp:
      return "ramp down";
    case Event::Finished:
      return "plan finished";
    case Event::HoldTooLong:
      return "held too long";
    case Event::Stop:
      return "stop: hold";
    case Event::StepReached:
      return "step reached";
    case Event::Unhealthy:
      return "not healthy";
    case Event::ArmedTooLong:
      return "armed too long without motion";
    case Event::SelfTestPassed:
      return "self-test passed";
    case Event::Healthy:
      return "healthy and plan sealed";
    case Event::Arm:
      return "armed on the device";
    case Event::Move:
      return "motion button pressed";
    case Event::VoltageGone:
      return "voltage is zero";
    case Event::Reset:
      return "reset on the device";
  }
  return "unknown event";
}

}  // namespace biopsy::safety
