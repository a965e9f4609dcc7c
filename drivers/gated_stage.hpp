// A needle stage behind its gate: the only way from a request to a voltage.
#pragma once

#include <cstdint>

#include "drivers/needle_stage.hpp"
#include "robot/msg/fixed_messages.hpp"

namespace biopsy::drivers {

class GatedStage {
 public:
  // `stage` must outlive this. `config_tag`: of the configuration it was started with; part of every
  // measurement.
  GatedStage(NeedleStage& stage, std::uint64_t config_tag) : stage_(stage) { last_.config_tag = config_tag; }

  // Beginning of a tick: sensors, and what the gate did in the last one.
  Measurement measure();
  // End of a tick: the newest request and permit, null where none came; `writers` as safety::gate.
  void drive(const DriveRequest* request, const Permit* permit, std::int64_t now_us, std::int32_t writers);

  // On the converter since the last drive(), signed.
  std::int32_t command_mV() const { return last_.command_mV; }
  // Whether the driver's half of the interlock gets a pulse in this tick.
  bool feeds_interlock() const { return feeds_interlock_; }

 private:
  NeedleStage& stage_;
  safety::GateState gate_;
  bool feeds_interlock_ = false;
  Measurement last_;  // seq and the gate's report
};

}  // namespace biopsy::drivers
