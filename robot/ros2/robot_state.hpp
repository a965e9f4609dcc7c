// What the robot's bus told last, as far as ROS 2 is told of it. Nothing old: what was not heard of for half
// a second is absent.
#pragma once

#include <array>
#include <optional>

#include "robot/common/frames.hpp"
#include "robot/msg/messages.hpp"

namespace biopsy::ros2 {

struct RobotState {
  std::optional<Measurement> measurement;
  std::optional<Decision> decision;
  std::optional<RigidTransform> X_SR;  // of the newest sealed plan; absent: none, or its seal does not hold
  std::array<Health, kCount<Process>> health;  // seq 0: silent
};

}  // namespace biopsy::ros2
