#include "robot/live/stage_loop.hpp"

namespace biopsy::live {

StageLoop::StageLoop(const transport::Participant& bus, drivers::NeedleStage& stage,
                     digital_io::StageIo& lines, std::uint64_t config_tag)
    : gated_(stage, config_tag),
      lines_(lines),
      measurements_(bus),
      permits_(bus),
      requests_(bus),
      heartbeat_(bus, Process::Stage, config_tag) {
  heartbeat_.health().ready = true;
}

// One of each is right. Any other number is passed on, so that the gate refuses.
std::int32_t StageLoop::writers() const {
  const int permits = permits_.writers();
  return permits != 1 ? permits : requests_.writers();
}

void StageLoop::tick(std::int64_t now_us) {
  permits_.take_newest(inputs_.permit);
  requests_.take_newest(inputs_.request);
  inputs_.now_us = now_us;
  inputs_.writers = writers();
  robot::actuate(inputs_, gated_);
  if (gated_.feeds_interlock()) lines_.pulse();
  measured_ = gated_.measure();
  measurements_.write(measured_);
  heartbeat_.beat(now_us);
}

void StageLoop::switch_off(std::int64_t now_us) {
  robot::GateInputs nothing;  // no permit, no writer: the gate puts out 0 V
  nothing.now_us = now_us;
  robot::actuate(nothing, gated_);
}

}  // namespace biopsy::live
