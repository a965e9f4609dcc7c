// A tick of the robot in lockstep: measure, monitor, decide, control, gate, drive, on one virtual clock. The
// three functions are those that the live processes call (supervise, control, actuate).
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "drivers/gated_stage.hpp"
#include "robot/cycle/actuate.hpp"
#include "robot/cycle/operator_inputs.hpp"
#include "robot/cycle/supervise.hpp"
#include "robot/msg/plan.hpp"
#include "safety/interlock.hpp"

namespace biopsy::robot {

struct CycleRecord {
  Measurement measurement;
  safety::Evidence evidence;
  safety::SupervisorOutput supervisor;
  DriveRequest request;
  std::int32_t panel_unread_ms = 0;  // as in Decision
  std::int32_t drive_mV = 0;         // on the converter from the end of the tick until the next
};

// Sees what was measured and decided in this tick; answers with what it requests.
using Controller = std::function<DriveRequest(const Measurement&, const safety::SupervisorOutput&)>;

class ControlCycle {
 public:
  // `stage` must outlive this. `confirmed`: the plan tags that two people confirmed. Begins after a person
  // tested the panel.
  ControlCycle(const Plan& plan, const safety::PlanFacts& facts, drivers::NeedleStage& stage,
               const std::array<std::uint64_t, 2>& confirmed);

  CycleRecord run(const OperatorInputs& operator_inputs, const Environment& environment,
                  const Controller& controller);

  // `faults` must outlive this.
  void wrap(FaultHooks& faults) { faults_ = &faults; }

  std::int64_t ticks() const { return ticks_; }
  Mode mode() const { return supervisor_.state.mode; }
  safety::PlanFacts& plan_facts() { return supervisor_.plan; }  // what the supervisor keeps of the plan

 private:
  SupervisorSources sources(const Measurement& measurement, const OperatorInputs& operator_inputs,
                            const Environment& environment) const;
  std::int64_t now_us() const { return (ticks_ + 1) * std::chrono::microseconds(kTick).count(); }

  FaultHooks* faults_ = nullptr;
  drivers::GatedStage stage_;
  SupervisorMemory supervisor_;
  DriveRequest request_;     // of the last tick
  safety::Interlock relay_;  // as hardware has it
  std::int64_t ticks_ = 0;
};

}  // namespace biopsy::robot
