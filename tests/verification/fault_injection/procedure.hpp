// One procedure, tick by tick: the rehearsal's own lockstep of stage, supervisor, controller and gate with
// its operator, the plant, and the interlock's relay in the amplifier's supply; breakable everywhere.
#pragma once

#include <cstdint>

#include "robot/control/step_runner.hpp"
#include "robot/procedure/operator.hpp"
#include "safety/interlock.hpp"
#include "sim/simulated_stage.hpp"
#include "tests/verification/fault_injection/corruptors.hpp"
#include "tests/verification/fault_injection/scene.hpp"

namespace biopsy::proof {

// One tick, as it is judged.
struct Line {
  std::int64_t tick = 0;
  Mode mode = Mode::Boot;
  safety::HazardSet hazards = 0;
  safety::Event event = safety::Event::None;
  std::uint32_t stage = 0;
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
  BreakableStage(const Scene& scene, const Corruptors& corruptors)
      : sound_(scene.plant, scene.noise_seed), spoilers_(corruptors) {}

  drivers::SensorReading read() override;
  void write(const safety::GatedVoltage& voltage) override;
  void pulse_from_supervisor();

  const sim::PlantState& truth() const { return sound_.truth(); }
  bool enabled() const { return asked_.hv_enabled(); }

 private:
  sim::SimulatedStage sound_;
  const Corruptors& spoilers_;
  safety::Interlock relay_;
  safety::GatedVoltage asked_ = safety::GatedVoltage::off();
};

// Hears what the supervisor and the gate are given in a tick.
using Tap = std::function<void(const safety::PlanFacts&, const safety::Observation&,
                               const safety::SupervisorInput&, const robot::Delivery&)>;

class Procedure final : private robot::FaultHooks {
 public:
  // `scene` must outlive this.
  explicit Procedure(const Scene& scene);
  Procedure(const Procedure&) = delete;
  Procedure& operator=(const Procedure&) = delete;

  // From the next tick on.
  void corrupt(Corruptors corruptors) { spoilers_ = std::move(corruptors); }
  void listen(Tap tap) { tap_ = std::move(tap); }
  Line tick();

  bool over() const { return person_.done(); }
  const robot::Operator& person() const { return person_; }
  const robot::CycleRecord& last() const { return last_; }
  const Scene& scene() const { return scene_; }
  safety::PlanFacts& facts() { return facts_; }  // the supervisor's memory of the plan

 private:
  void carry(safety::Observation& seen) override;
  void carry(safety::SupervisorInput& input) override;
  void carry(robot::Delivery& delivery) override;

  const Scene& scene_;
  safety::PlanFacts facts_;
  Corruptors spoilers_;
  BreakableStage stage_;
  robot::ControlCycle supervised_;
  control::RunnerState controller_;
  robot::Operator person_;
  robot::CycleRecord last_;
  std::int32_t switched_from_mV_ = 0;
  Tap tap_;
  safety::Observation seen_;  // of this tick, for the tap
  safety::SupervisorInput asked_;
  Line line_;
};

}  // namespace biopsy::proof
