// The controller process: runs the sealed plan, one control tick for each measurement. It only requests.
#pragma once

#include <chrono>
#include <cstdint>

#include "robot/cycle/control.hpp"
#include "robot/live/heartbeat.hpp"
#include "robot/transport/bus.hpp"

namespace biopsy::live {

class ControllerLoop {
 public:
  ControllerLoop(const transport::Participant& bus, std::uint64_t config_tag);

  // Waits up to `timeout` for a measurement and answers it.
  void turn(std::chrono::nanoseconds timeout);

  Heartbeat& heartbeat() { return heartbeat_; }

 private:
  void take_plan();

  transport::Reader<Measurement> measurements_;
  transport::Reader<Permit> permits_;
  transport::Reader<Decision> decisions_;
  transport::Reader<OperatorAct> acts_;
  transport::Reader<SealedPlan> plans_;
  transport::Writer<DriveRequest> requests_;
  transport::WaitSet wait_set_;
  Heartbeat heartbeat_;
  robot::ControllerMemory controller_;
  robot::ControllerInputs inputs_;
  Decision decision_;
  OperatorAct act_;
};

}  // namespace biopsy::live
