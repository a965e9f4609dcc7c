// The controller process: runs the sealed plan, one control tick for each measurement. It only asks.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "robot/control/step_runner.hpp"
#include "robot/live/heartbeat.hpp"
#include "robot/msg/plan.hpp"
#include "robot/transport/bus.hpp"

namespace biopsy::live {

class ControllerLoop {
 public:
  ControllerLoop(const transport::Participant& bus, std::uint64_t config_tag);

  // Waits up to `patience` for a measurement and answers it.
  void turn(std::chrono::nanoseconds patience);

  Heartbeat& heartbeat() { return heartbeat_; }

 private:
  void take_plan();
  DriveRequest answer(const Measurement& measured);

  transport::Reader<Measurement> measurements_;
  transport::Reader<Permit> permits_;
  transport::Reader<Decision> decisions_;
  transport::Reader<OperatorAct> acts_;
  transport::Reader<SealedPlan> plans_;
  transport::Writer<DriveRequest> requests_;
  transport::WaitSet wait_set_;
  Heartbeat heartbeat_;
  std::uint64_t config_tag_;
  std::uint64_t plan_tag_ = 0;
  std::optional<Plan> plan_;
  control::RunnerState runner_;
  Permit permit_;
  Decision decision_;
  OperatorAct act_;
  std::uint32_t overruns_ = 0;
};

}  // namespace biopsy::live
