// Health of a process: its configuration, readiness and timing, sent ten times a second.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "robot/live/realtime/latency_histogram.hpp"
#include "robot/msg/messages.hpp"
#include "robot/transport/bus.hpp"

namespace biopsy::live {

inline constexpr std::int64_t kHealthEvery_us = 100'000;

class Heartbeat {
 public:
  Heartbeat(const transport::Participant& bus, Process process, std::uint64_t config_tag);

  // Call in every tick; sends every kHealthEvery_us.
  void beat(std::int64_t now_us);

  Health& health() { return health_; }  // sent next
  void note(std::string_view text);     // the first 120 characters; does not allocate
  realtime::LatencyHistogram& lateness() { return lateness_; }

 private:
  transport::Writer<Health> writer_;
  Health health_;
  realtime::LatencyHistogram lateness_;
  std::int64_t sent_us_ = 0;
};

// The newest health of every process.
class HealthBoard {
 public:
  explicit HealthBoard(const transport::Participant& bus) : reader_(bus) {}

  void update(std::int64_t now_us);
  // Older than half a second: as if it had never arrived.
  Health of(Process process, std::int64_t now_us) const;

 private:
  transport::Reader<Health> reader_;
  std::array<Health, kCount<Process>> last_{};
  std::array<std::int64_t, kCount<Process>> received_us_{};
};

}  // namespace biopsy::live
