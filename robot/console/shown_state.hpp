// When a page needs another State: where something lasting changed at once, where a value that people read
// changed its last shown digit soon, otherwise seldom. A robot that waits would else send the same a few
// times a second, and each message costs the browser time.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "robot/msg/console_messages.hpp"

namespace biopsy::robot {

class ShownState {
 public:
  static constexpr std::int64_t kChanged_us = 100'000, kSame_us = 500'000;
  enum class Due { No, BestEffort, Reliable };

  Due due(const console::events::State& now, std::int64_t now_us) const {
    if (!sent_ || lasting(now) != lasting(*sent_)) return Due::Reliable;
    const std::int64_t since_us = now_us - sent_us_;
    return since_us >= (reads_the_same(now, *sent_) ? kSame_us : kChanged_us) ? Due::BestEffort : Due::No;
  }
  void note(console::events::State sent, std::int64_t now_us) {
    sent_ = std::move(sent);
    sent_us_ = now_us;
  }

 private:
  // Without the values that change in every tick.
  static std::string lasting(console::events::State state) {
    state.seq = 0;
    state.depth = state.drive = state.arm_held = 0.0;
    state.hold_left = state.armed_left = state.ticks_left = state.carried_left = 0.0;
    return nlohmann::json(state).dump();
  }
  // In the steps of the page (shown_state.ts).
  static bool reads_the_same(const console::events::State& one, const console::events::State& other) {
    constexpr double kDepth_mm = 0.01, kDrive_kV = 0.02, kMinute_s = 60.0;
    const auto whole = [](double value) { return std::ceil(value); };
    return std::abs(one.depth - other.depth) < kDepth_mm && std::abs(one.drive - other.drive) < kDrive_kV &&
           whole(one.hold_left) == whole(other.hold_left) &&
           whole(one.armed_left) == whole(other.armed_left) &&
           whole(one.ticks_left) == whole(other.ticks_left) &&
           whole(one.carried_left / kMinute_s) == whole(other.carried_left / kMinute_s) &&
           one.arm_held == other.arm_held;
  }

  std::optional<console::events::State> sent_;
  std::int64_t sent_us_ = 0;
};

}  // namespace biopsy::robot
