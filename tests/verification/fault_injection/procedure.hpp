// One procedure, tick by tick: the rehearsal's own lockstep of stage, supervisor, controller and gate with
// its operator, the plant, and the interlock's relay in the amplifier's supply; breakable everywhere.
#pragma once

#include <cstdint>

#include "robot/cycle/control.hpp"
#include "robot/procedure/operator.hpp"
#include "safety/interlock.hpp"
#include "sim/simulated_stage.hpp"
#include "tests/safety/situation.hpp"
#include "tests/verification/fault_injection/corruptors.hpp"
#include "tests/verification/fault_injection/scenario.hpp"

namespace biopsy::fault_injection {

// One tick, as it is judged.
struct TickRecord {
  std::int64_t tick = 0;
  Mode mode = Mode::Boot;
  safety::HazardSet hazards = 0;
  safety::Event event = safety::Event::None;
  std::uint32_t step = 0;
  bool flagged = false;         // the image of this moment is marked as disturbed
  bool shown = false;           // this sample shows the fault
  bool enabled = false;         // high voltage, by the gate
  std::int32_t command_mV = 0;  // of the gate, from the end of this tick
  double output_kV = 0.0;       // true, from the end of this tick, signed
  double depth_mm = 0.0;        // true
  std::int32_t seen_um = 0, monitor_mV = 0, current_nA = 0;
};

class BreakableStage final : public drivers::NeedleStage {
 public:
  BreakableStage(const Scenario& scenario, const Corruptors& corruptors)
      : sound_(scenario.plant, scenario.noise_seed), corruptors_(corruptors) {}

  drivers::SensorReading read() override;
  std::int32_t write(const safety::GatedVoltage& voltage) override;
  void pulse_from_supervisor();

  const sim::PlantState& truth() const { return sound_.truth(); }
  bool enabled() const { return asked_.hv_enabled(); }

 private:
  sim::SimulatedStage sound_;
  const Corruptors& corruptors_;
  safety::Interlock relay_;
  safety::GatedVoltage asked_ = safety::GatedVoltage::off();
};

// Gets what the supervisor and the gate are given in a tick.
using Observer = std::function<void(const safety::PlanFacts&, const safety::SupervisorInputs&,
                                    const safety::Situation&, const robot::GateInputs&)>;

class Procedure final : private robot::FaultHooks {
 public:
  // `scenario` must outlive this.
  explicit Procedure(const Scenario& scenario);
  Procedure(const Procedure&) = delete;
  Procedure& operator=(const Procedure&) = delete;

  // From the next tick on.
  void corrupt(Corruptors corruptors) { corruptors_ = std::move(corruptors); }
  void observe(Observer observer) { observer_ = std::move(observer); }
  TickRecord tick();

  bool over() const { return operator_.done(); }
  const robot::Operator& simulated_operator() const { return operator_; }
  const robot::CycleRecord& last() const { return last_; }
  const robot::OperatorInputs& inputs() const { return inputs_; }  // of the last tick
  const Scenario& scenario() const { return scenario_; }
  safety::PlanFacts& facts() { return supervised_.plan_facts(); }  // the supervisor's memory of the plan

 private:
  void before_monitors(safety::SupervisorInputs& inputs) override;
  void before_decision(safety::SupervisorInputs& inputs, safety::Evidence& evidence) override;
  void before_gate(robot::GateInputs& inputs) override;

  const Scenario& scenario_;
  Corruptors corruptors_;
  BreakableStage stage_;
  robot::ControlCycle supervised_;
  robot::ControllerMemory controller_;
  robot::Operator operator_;
  robot::CycleRecord last_;
  robot::OperatorInputs inputs_;
  std::int32_t switched_from_mV_ = 0;
  Observer observer_;
  safety::SupervisorInputs seen_;  // of this tick, for the observer
  safety::Situation decided_on_;
  TickRecord line_;
};

}  // namespace biopsy::fault_injection
