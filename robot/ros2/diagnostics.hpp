// The robot's state as diagnostic_msgs/DiagnosticStatus has it, for rqt_robot_monitor and
// diagnostic_aggregator.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "robot/ros2/robot_state.hpp"

namespace biopsy::ros2 {

enum class DiagnosticLevel : std::uint8_t { Ok, Warn, Error, Stale };

struct Diagnostic {
  DiagnosticLevel level = DiagnosticLevel::Stale;
  std::string name, message;
  std::vector<std::pair<std::string, std::string>> values;  // key, value; units are in the keys
};

// Supervisor, needle, and each process; a console and a navigation program only where they are heard.
std::vector<Diagnostic> diagnostics_of(const RobotState& state);

}  // namespace biopsy::ros2
