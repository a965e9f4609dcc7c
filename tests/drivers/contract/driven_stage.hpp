// A stage behind the gate, with permits made by the test.
#pragma once

#include <cstdint>

#include "drivers/gated_stage.hpp"

namespace biopsy {

class DrivenStage {
 public:
  explicit DrivenStage(drivers::NeedleStage& stage) : stage_(stage, 0) { tick(0, false); }

  // One tick: reads, then writes the requested voltage through the gate.
  Measurement tick(std::int32_t wanted_mV, bool enabled = true, bool brake = false) {
    const Measurement measured = stage_.measure();
    now_us_ += 1'000;
    Permit permit;
    permit.session = permit.epoch = 1;
    permit.seq = ++seq_;
    permit.ttl_us = 5'000;
    permit.hv_enable = enabled;
    permit.mode = enabled ? Mode::Active : Mode::Safe;
    permit.stop = enabled ? StopCategory::None : StopCategory::C0Off;
    permit.v_max_mV = 8'000'000;
    permit.slew_up_mV_per_tick = 400'000;
    permit.brake = true;
    const DriveRequest request{.seq = seq_, .wanted_mV = wanted_mV, .brake = brake};
    stage_.drive(&request, &permit, now_us_, 1);
    return measured;
  }

  // The measurement of the last tick.
  Measurement hold(std::int32_t wanted_mV, int ticks) {
    Measurement last;
    for (int k = 0; k < ticks; ++k) last = tick(wanted_mV);
    return last;
  }

  std::int32_t command_mV() const { return stage_.command_mV(); }

 private:
  drivers::GatedStage stage_;
  std::int64_t now_us_ = 0;
  std::uint32_t seq_ = 0;
};

}  // namespace biopsy
