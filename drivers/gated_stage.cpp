#include "drivers/gated_stage.hpp"

namespace biopsy::drivers {

Measurement GatedStage::measure() {
  const SensorReading reading = stage_.read();
  ++last_.seq;
  last_.time_us = reading.time_us;
  last_.depth_um = reading.depth_um;
  last_.laser_code = reading.laser_code;
  last_.laser_valid = reading.laser_valid;
  last_.depth_b_um = reading.depth_b_um;
  last_.laser_b_valid = reading.laser_b_valid;
  last_.monitor_mV = reading.monitor_mV;
  last_.current_nA = reading.current_nA;
  last_.brake_fitted = reading.brake_fitted;
  return last_;
}

void GatedStage::drive(const DriveRequest* request, const Permit* permit, std::int64_t now_us,
                       std::int32_t writers) {
  const safety::GateResult result = safety::gate(gate_, request, permit, now_us, writers);
  gate_ = result.state;
  // The answer is the gate's: over a voltage that is not its own it is wrong, and the supervisor sees it.
  last_.command_mV = stage_.write(result.voltage);
  feeds_interlock_ = result.voltage.feeds_interlock();
  last_.hv_enabled = result.voltage.hv_enabled();
  last_.brake_on = result.voltage.brake_on();
  last_.verdict = result.verdict;
  last_.answer = result.answer;
  last_.answered_seq = result.answered_seq;
}

}  // namespace biopsy::drivers
