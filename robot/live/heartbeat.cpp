#include "robot/live/heartbeat.hpp"

namespace biopsy::live {
namespace {

constexpr std::int64_t kForgotten_us = 500'000;
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

void HealthBoard::look(std::int64_t now_us) {
  Health heard;
  while (reader_.take(heard)) {
    const auto process = static_cast<std::size_t>(heard.process);
    last_[process] = heard;
    heard_us_[process] = now_us;
  }
}

Health HealthBoard::of(Process process, std::int64_t now_us) const {
  const auto index = static_cast<std::size_t>(process);
  const bool fresh = heard_us_[index] != 0 && now_us - heard_us_[index] <= kForgotten_us;
  if (fresh) return last_[index];
  Health unheard;
  unheard.process = process;
  return unheard;
}

}  // namespace biopsy::live
