#include "robot/console/server/hold_to_run.hpp"

#include <algorithm>

namespace biopsy::console {

bool HoldToRun::press(std::uint32_t token, double page_ms, std::int64_t now_us) {
  if (token != next_ || held(now_us)) return false;
  ++next_;
  pressed_ = Pressed{token, now_us, now_us, page_ms, static_cast<double>(now_us) * 1e-3 - page_ms};
  return true;
}

void HoldToRun::beat(std::uint32_t token, double page_ms, std::int64_t now_us) {
  if (!held(now_us) || pressed_->token != token) return;
  const double offset_ms = static_cast<double>(now_us) * 1e-3 - page_ms;
  if (page_ms <= pressed_->page_ms || offset_ms - pressed_->fastest_ms > kDelayMax_ms) {
    pressed_.reset();
    return;
  }
  pressed_->fastest_ms = std::min(pressed_->fastest_ms, offset_ms);
  pressed_->page_ms = page_ms;
  pressed_->beat_us = now_us;
}

void HoldToRun::release(std::uint32_t token) {
  if (pressed_ && pressed_->token == token) pressed_.reset();
}

std::optional<std::uint32_t> HoldToRun::held(std::int64_t now_us) {
  if (pressed_ && now_us - pressed_->beat_us > kBeatMax_us) pressed_.reset();
  if (!pressed_) return std::nullopt;
  return pressed_->token;
}

std::int64_t HoldToRun::held_for_us(std::int64_t now_us) {
  return held(now_us) ? now_us - pressed_->since_us : 0;
}

}  // namespace biopsy::console
