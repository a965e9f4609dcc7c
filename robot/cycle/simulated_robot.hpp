// A needle stage, supervisor, controller and gate on one virtual clock. Same inputs, same run, to the
// bit.
#pragma once

#include <array>
#include <cstdint>

#include "robot/cycle/control.hpp"
#include "robot/cycle/run_cycle.hpp"

namespace biopsy::robot {

class SimulatedRobot {
 public:
  // As ControlCycle; the controller runs `plan`.
  SimulatedRobot(const Plan& plan, const safety::PlanFacts& facts, drivers::NeedleStage& stage,
                 const std::array<std::uint64_t, 2>& confirmed)
      : cycle_(plan, facts, stage, confirmed) {
    load_plan(plan, controller_);
  }

  CycleRecord run_cycle(const OperatorInputs& operator_inputs,
                        const Environment& environment = Environment::healthy()) {
    return cycle_.run(operator_inputs, environment,
                      [&](const Measurement& measurement, const safety::SupervisorOutput& decided) {
                        return control({.measurement = measurement,
                                        .permit = decided.permit,
                                        .step = decided.step,
                                        .finish = operator_inputs.finish,
                                        .hold_still = operator_inputs.hold_still},
                                       controller_);
                      });
  }

  // As ControlCycle::wrap.
  void wrap(FaultHooks& faults) { cycle_.wrap(faults); }

  std::int64_t ticks() const { return cycle_.ticks(); }
  Mode mode() const { return cycle_.mode(); }
  const control::RunnerState& controller() const { return controller_.runner; }

 private:
  ControlCycle cycle_;
  ControllerMemory controller_;
};

}  // namespace biopsy::robot
