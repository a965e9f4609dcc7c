// The places where a real robot can break, each between two parts of the shipped code. Empty: sound.
#pragma once

#include <functional>

#include "robot/cycle/run_cycle.hpp"
#include "sim/plant/plant.hpp"
#include "tests/safety/situation.hpp"

namespace biopsy::fault_injection {

// What the supervisor is shown in a tick, and what was true then.
struct ObservedTick {
  const safety::SupervisorInputs& seen;
  const sim::Motion& truth;
  bool disturbing;  // the drive was switched in the tick that this sample reports
};

struct Corruptors {
  std::function<void(robot::OperatorInputs&)> world = {};  // operator, scanner, panel
  std::function<void(robot::Environment&)> environment = {};
  std::function<void(drivers::SensorReading&)> reading = {};
  bool one_laser = false;  // `reading` is of the first laser alone
  // V, signed, on the stack. A sound one gives what is asked while the relay is closed.
  std::function<double(double asked_V, bool enabled, bool relay_closed)> amplifier = {};
  std::function<double(const sim::Motion&)> push_N = {};            // a force from outside, withdrawing
  bool driver_stopped = false;                                      // converter and monitors stand, no pulse
  std::function<void(safety::SupervisorInputs&)> observation = {};  // on the way to the supervisor
  std::function<void(safety::Situation&)> input = {};               // inside of it
  std::function<void(DriveRequest&)> request = {};                  // inside the controller
  std::function<void(robot::GateInputs&)> delivery = {};            // on the way to the gate
  // Whether this sample shows the fault by the limit that docs/reference/supervisor.md states. Empty: every
  // one does.
  std::function<bool(const ObservedTick&)> shows = {};
};

}  // namespace biopsy::fault_injection
