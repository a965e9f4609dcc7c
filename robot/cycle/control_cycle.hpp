// A stage under its supervisor and behind its gate, on one virtual clock: the very functions that the live
// processes run, called in turn, one tick at a time. Whoever asks for voltages is passed in.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "drivers/gated_stage.hpp"
#include "robot/msg/plan.hpp"
#include "safety/monitors/evidence.hpp"
#include "safety/monitors/tissue_monitor.hpp"
#include "safety/supervisor.hpp"

namespace biopsy::robot {

// What people and the rest of the world do in a tick. Default: nobody asks for anything and all is well.
struct World {
  bool arm = false, reset = false;                // keys on the device
  bool remote_arm = false, remote_reset = false;  // asked over the network: always refused
  safety::MotionPress press;                      // hold-to-run
  StopCategory stop = StopCategory::None;
  bool finish = false;          // the operator is done: withdraw
  bool acquiring = false;       // the scanner takes an image
  bool depth_accepted = false;  // the depth check of `accepted_stage` said Accept
  std::uint32_t accepted_stage = 0;
  std::int32_t patient_motion_um = 0;
  std::int32_t log_backlog_ms = 0;
  bool estop_closed = true;
  std::int32_t writers = 1;
  bool bench_confirmed = false;  // no patient, no needle
};

struct CycleRecord {
  Measurement measurement;
  safety::Evidence evidence;
  safety::SupervisorOutput supervisor;
  DriveRequest request;
  std::int32_t drive_mV = 0;  // put out at the end of the tick, until the next
};

// The ways between the parts. These carry everything as it was sent; fault injection brings its own.
struct Delivery {
  const DriveRequest* request;  // null: lost
  const Permit* permit;
  std::int64_t now_us;  // gate's clock
  std::int32_t writers;
};
class FaultHooks {
 public:
  virtual ~FaultHooks() = default;
  virtual void carry(safety::Observation& /*to the supervisor*/) {}
  virtual void carry(safety::SupervisorInput& /*to its decision*/) {}
  virtual void carry(Delivery& /*to the gate*/) {}
};

class ControlCycle {
 public:
  // Sees what was measured and decided in this tick; answers with what it wants.
  using Controller = std::function<DriveRequest(const Measurement&, const safety::SupervisorOutput&)>;

  // `plan`, `facts` and `stage` must outlive this. `confirmed`: the plan tags that two people confirmed.
  ControlCycle(const Plan& plan, const safety::PlanFacts& facts, drivers::NeedleStage& stage,
               const std::array<std::uint64_t, 2>& confirmed);

  CycleRecord tick(const World& world, const Controller& controller);

  // `wires` must outlive this.
  void connect(FaultHooks& wires) { faults_ = &wires; }

  std::int64_t ticks() const { return ticks_; }
  Mode mode() const { return supervisor_.mode; }

 private:
  safety::Observation observed(const Measurement& measurement, const World& world);
  std::int64_t now_us() const { return (ticks_ + 1) * std::chrono::microseconds(kTick).count(); }

  FaultHooks* faults_ = nullptr;  // none: everything arrives
  const safety::PlanFacts& facts_;
  std::array<std::uint64_t, 2> confirmed_;
  std::uint64_t plan_tag_;  // of the plan the controller really runs, sealed anew here
  drivers::GatedStage stage_;
  safety::EvidenceMemory memory_;
  safety::TissueMonitor tissue_;
  safety::SupervisorState supervisor_;
  Permit permit_;
  DriveRequest request_;
  std::int64_t ticks_ = 0;
};

}  // namespace biopsy::robot
