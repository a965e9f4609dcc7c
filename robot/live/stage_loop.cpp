#include "robot/live/stage_loop.hpp"

namespace biopsy::live {

StageLoop::StageLoop(const transport::Participant& bus, drivers::NeedleStage& stage,
                     digital_io::StageIo& lines, std::uint64_t config_tag)
    : gated_(stage),
      lines_(lines),
      measurements_(bus),
      permits_(bus),
      requests_(bus),
      heartbeat_(bus, Process::Stage, config_tag),
      config_tag_(config_tag) {
  heartbeat_.health().ready = true;
}

// One of each is right. Any other number is passed on, so that the gate refuses.
std::int32_t StageLoop::writers() const {
  const int permits = permits_.writers();
  return permits != 1 ? permits : requests_.writers();
}

void StageLoop::tick(std::int64_t now_us) {
  permits_.take_newest(permit_);
  requests_.take_newest(request_);
  // An older message is none to the gate, which knows them by their numbers.
  gated_.drive(request_.seq != 0 ? &request_ : nullptr, permit_.seq != 0 ? &permit_ : nullptr, now_us,
               writers());
  lines_.pulse();
  measured_ = gated_.measure();
  measured_.config_tag = config_tag_;
  measurements_.write(measured_);
  heartbeat_.beat(now_us);
}

void StageLoop::switch_off(std::int64_t now_us) {
  gated_.drive(nullptr, nullptr, now_us, 0);  // nobody to ask: the gate puts out 0 V
}

}  // namespace biopsy::live
