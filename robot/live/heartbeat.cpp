#include "robot/live/heartbeat.hpp"

namespace biopsy::live {
namespace {

constexpr std::int64_t kHealthMax_us = 500'000;
constexpr std::size_t kNoteMax = 120;

std::int32_t bounded(std::int64_t us) {
  return static_cast<std::int32_t>(std::min<std::int64_t>(us, INT32_MAX));
}

}  // namespace

Heartbeat::Heartbeat(const transport::Participant& bus, Process process, std::uint64_t config_tag)
    : writer_(bus) {
  health_.process = process;
  health_.config_tag = config_tag;
  health_.note.reserve(kNoteMax);
}

void Heartbeat::note(std::string_view text) {
  health_.note.assign(text.substr(0, kNoteMax));
}

void Heartbeat::beat(std::int64_t now_us) {
  if (now_us - sent_us_ < kHealthEvery_us) return;
  sent_us_ = now_us;
  ++health_.seq;
  health_.late_p50_us = bounded(lateness_.p50_us());
  health_.late_p99_us = bounded(lateness_.p99_us());
  health_.late_max_us = bounded(lateness_.max_us());
  health_.refused = transport::unauthenticated_messages();
  writer_.write(health_);
}

void HealthBoard::update(std::int64_t now_us) {
  Health received;
  while (reader_.take(received)) {
    const auto process = static_cast<std::size_t>(received.process);
    last_[process] = received;
    received_us_[process] = now_us;
  }
}

Health HealthBoard::of(Process process, std::int64_t now_us) const {
  const auto index = static_cast<std::size_t>(process);
  const bool fresh = received_us_[index] != 0 && now_us - received_us_[index] <= kHealthMax_us;
  if (fresh) return last_[index];
  Health unknown;
  unknown.process = process;
  return unknown;
}

}  // namespace biopsy::live
