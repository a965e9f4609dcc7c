// A procedure's stage, supervisor, controller and gate on one virtual clock. Same inputs, same run, to the
// bit.
#pragma once

#include <array>
#include <cstdint>

#include "robot/control/step_runner.hpp"
#include "robot/cycle/control_cycle.hpp"
#include "robot/msg/plan.hpp"

namespace biopsy::robot {

class SimulatedRobot {
 public:
  // `plan`, `facts` and `stage` must outlive this. `confirmed`: the plan tags that two people confirmed.
  SimulatedRobot(const Plan& plan, const safety::PlanFacts& facts, drivers::NeedleStage& stage,
                 const std::array<std::uint64_t, 2>& confirmed)
      : plan_(plan), stage_(plan, facts, stage, confirmed) {}

  CycleRecord tick(const World& world);

  std::int64_t ticks() const { return stage_.ticks(); }
  Mode mode() const { return stage_.mode(); }
  const control::RunnerState& controller() const { return controller_; }

 private:
  const Plan& plan_;
  ControlCycle stage_;
  control::RunnerState controller_;
};

}  // namespace biopsy::robot
