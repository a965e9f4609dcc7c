// How a process tells the others that it is alive, with what configuration, and how it keeps time.
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

  // Call in every tick: sends now and then.
  void beat(std::int64_t now_us);

  Health& health() { return health_; }  // what is said next
  void note(std::string_view text);     // for a person: its first 120 characters; does not allocate
  realtime::LatencyHistogram& lateness() { return lateness_; }

 private:
  transport::Writer<Health> writer_;
  Health health_;
  realtime::LatencyHistogram lateness_;
  std::int64_t sent_us_ = 0;
};

// The last word of every process, and how old it is.
class HealthBoard {
 public:
  explicit HealthBoard(const transport::Participant& bus) : reader_(bus) {}

  void look(std::int64_t now_us);
  // Nothing for more than half a second: as if it had never been heard.
  Health of(Process process, std::int64_t now_us) const;

 private:
  transport::Reader<Health> reader_;
  std::array<Health, kCount<Process>> last_{};
  std::array<std::int64_t, kCount<Process>> heard_us_{};
};

}  // namespace biopsy::live
