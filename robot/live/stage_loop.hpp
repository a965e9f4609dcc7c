// The stage process: owns sensors and amplifier, and the gate. One tick of 1 ms:
//   newest permit and request -> gate -> converter;  pulse to the interlock;  sensors -> Measurement.
// So what answers measurement k is put out in tick k + 1, whatever the other processes' jitter within it.
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/digital_io/io_views.hpp"
#include "robot/cycle/actuate.hpp"
#include "robot/live/heartbeat.hpp"
#include "robot/transport/bus.hpp"

namespace biopsy::live {

class StageLoop {
 public:
  // `stage` must outlive this.
  StageLoop(const transport::Participant& bus, drivers::NeedleStage& stage, digital_io::StageIo& lines,
            std::uint64_t config_tag);

  // `now_us`: this machine's monotonic clock.
  void tick(std::int64_t now_us);

  // 0 V: the last act.
  void switch_off(std::int64_t now_us);

  Heartbeat& heartbeat() { return heartbeat_; }
  const Measurement& measured() const { return measured_; }

 private:
  std::int32_t writers() const;

  drivers::GatedStage gated_;
  digital_io::StageIo& lines_;
  transport::Writer<Measurement> measurements_;
  transport::Reader<Permit> permits_;
  transport::Reader<DriveRequest> requests_;
  Heartbeat heartbeat_;
  robot::GateInputs inputs_;
  Measurement measured_;
};

}  // namespace biopsy::live
