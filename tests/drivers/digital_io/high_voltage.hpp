// A voltage that the gate let through: there is no other way to have one.
#pragma once

#include "safety/gate.hpp"
#include "safety/types/limits.hpp"

namespace biopsy::digital_io {

inline safety::GatedVoltage high_voltage(std::int32_t mV) {
  Permit permit{.session = 1, .epoch = 1, .ttl_us = limits::kPermitTtl_us, .mode = Mode::Safe};
  DriveRequest request{.wanted_mV = mV};
  safety::GateResult result;
  for (std::int64_t tick = 1; tick < 40; ++tick) {  // 40 x 400 V are more than the gate ever gives
    ++permit.seq, ++request.seq;
    result = safety::gate(result.state, &request, &permit, tick * 1'000, 1);
    permit.mode = Mode::Active, permit.stop = StopCategory::None, permit.hv_enable = true;
    permit.v_max_mV = limits::kDriveMax_mV, permit.slew_up_mV_per_tick = 400'000;
  }
  return result.voltage;
}

}  // namespace biopsy::digital_io
