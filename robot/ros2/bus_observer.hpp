// The robot over its bus, as its role Observer reads it. That role may write nothing, and nothing here can.
#pragma once

#include <cstdint>

#include "robot/live/heartbeat.hpp"
#include "robot/ros2/robot_state.hpp"
#include "robot/transport/bus.hpp"

namespace biopsy::ros2 {

class BusObserver {
 public:
  explicit BusObserver(const transport::Participant& bus);

  // `now_us`: monotonic.
  RobotState state(std::int64_t now_us);

 private:
  transport::Reader<Measurement> measurements_;
  transport::Reader<Decision> decisions_;
  transport::Reader<SealedPlan> plans_;
  live::HealthBoard board_;
  Measurement measurement_;
  Decision decision_;
  std::optional<RigidTransform> X_SR_;
  std::int64_t measured_us_ = 0, decided_us_ = 0;
};

}  // namespace biopsy::ros2
