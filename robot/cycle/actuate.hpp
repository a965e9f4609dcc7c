// Gate and drive: from request and permit to the voltage on the converter. The one place where the gate's
// inputs are put together, live and in lockstep.
#pragma once

#include <cstdint>

#include "drivers/gated_stage.hpp"
#include "robot/cycle/fault_hooks.hpp"
#include "robot/msg/fixed_messages.hpp"

namespace biopsy::robot {

struct GateInputs {
  DriveRequest request;      // newest; seq 0: none yet
  Permit permit;             // likewise
  std::int64_t now_us = 0;   // driver's monotonic clock
  std::int32_t writers = 0;  // of requests and permits; exactly 1 is right
};

inline void actuate(GateInputs in, drivers::GatedStage& stage, FaultHooks* faults = nullptr) {
  if (faults != nullptr) faults->before_gate(in);
  stage.drive(in.request.seq != 0 ? &in.request : nullptr, in.permit.seq != 0 ? &in.permit : nullptr,
              in.now_us, in.writers);
}

}  // namespace biopsy::robot
