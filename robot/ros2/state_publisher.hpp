// The robot's state as ROS 2 topics, in metres (REP 103):
//   /joint_states       sensor_msgs/JointState         depth of the prismatic joint `needle`
//   /needle/depth       std_msgs/Float64               the same
//   /needle/state/pose  geometry_msgs/PoseStamped      tip, +z in the direction of insertion, frame
//   `scanner_ras`; with
//                                                      a sealed plan only, which holds where the robot stands
//   /supervisor/state   std_msgs/String                the mode, such as "active"; ten times a second
//   /diagnostics        diagnostic_msgs/DiagnosticArray  once a second
// What is not measured now is not published. Stamps are this machine's wall clock when the sample was
// received.
#pragma once

#include <cstdint>

#include "robot/ros2/robot_state.hpp"
#include "robot/ros2/ros_node.hpp"

namespace biopsy::ros2 {

class StatePublisher {
 public:
  // Throws ConfigError.
  StatePublisher(const RosSettings& settings, std::uint32_t robot);

  // `now_us`: monotonic; `wall_ns`: UTC since 1970. Depth and pose are published in each call with a new
  // measurement.
  void publish(const RobotState& state, std::int64_t now_us, std::int64_t wall_ns);

 private:
  void publish_needle(const RobotState& state, std::int64_t wall_ns);
  void publish_mode(const Decision& decision);
  void publish_diagnostics(const RobotState& state, std::int64_t wall_ns);

  RosNode node_;
  std::string hardware_;
  std::size_t joints_, depth_, pose_, mode_, diagnostics_;
  std::uint32_t measured_seq_ = 0;
  std::int64_t mode_us_ = 0, diagnostics_us_ = 0;
};

}  // namespace biopsy::ros2
