// Sixty ticks in one message, of which 30 s fill a plot's columns of pixels: minimum and maximum of each
// value, so that a spike of one tick is drawn. Twice as many where they are as those before, within the
// noise: a robot at rest.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "robot/msg/console_messages.hpp"

namespace biopsy::console {

inline constexpr int kBatch_ticks = 60, kStillBatch_ticks = 120;

class TelemetryBatch {
 public:
  struct Sample {
    double time_ms = 0, depth_mm = 0, setpoint_mm = 0, drive_kV = 0, envelope_kV = 0;
  };
  // The batch, with its last sample.
  std::optional<events::Telemetry> add(const Sample& sample) {
    if (count_++ == 0)
      batch_ = {sample.time_ms,  sample.depth_mm, sample.depth_mm,   sample.setpoint_mm,
                sample.drive_kV, sample.drive_kV, sample.envelope_kV};
    batch_.depth_low = std::min(batch_.depth_low, sample.depth_mm);
    batch_.depth_high = std::max(batch_.depth_high, sample.depth_mm);
    batch_.drive_low = std::min(batch_.drive_low, sample.drive_kV);
    batch_.drive_high = std::max(batch_.drive_high, sample.drive_kV);
    batch_.setpoint = sample.setpoint_mm;
    batch_.envelope = sample.envelope_kV;
    if (count_ < kBatch_ticks || (count_ < kStillBatch_ticks && is_like(batch_, last_))) return std::nullopt;
    count_ = 0;
    return last_ = batch_;
  }

 private:
  static bool is_like(const events::Telemetry& one, const events::Telemetry& other) {
    constexpr double kDepth_mm = 0.1, kDrive_kV = 0.05, kGiven = 0.01;
    return std::abs(one.depth_low - other.depth_low) < kDepth_mm &&
           std::abs(one.depth_high - other.depth_high) < kDepth_mm &&
           std::abs(one.drive_low - other.drive_low) < kDrive_kV &&
           std::abs(one.drive_high - other.drive_high) < kDrive_kV &&
           std::abs(one.setpoint - other.setpoint) < kGiven &&
           std::abs(one.envelope - other.envelope) < kGiven;
  }

  events::Telemetry batch_, last_;
  int count_ = 0;
};

}  // namespace biopsy::console
