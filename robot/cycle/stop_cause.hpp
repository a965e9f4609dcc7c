// What H-25 was found for, in words: the emergency stop was seen pressed, or nobody could read it. Both stop
// the robot alike and stay until the reset key is turned; who looks for the cause must be told which it was.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "drivers/digital_io/io_layout.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::robot {

// Values of Decision::panel_unread_ms that are no time.
inline constexpr std::int32_t kSeenPressed = 0;
inline constexpr std::int32_t kNotYetSeenReleased = -1;  // since the supervisor's start

// Follows the panel from tick to tick. Tells, decides nothing.
class StopCause {
 public:
  // `found`: H-25 in this tick. The answer changes when H-25 is found anew, when the panel is read again
  // after having been unread, and when the stop is seen pressed; it stays over the reset, for what is told
  // later.
  std::int32_t update(const digital_io::PanelReading& panel, bool found) {
    const bool open = !panel.levels.estop_a_closed || !panel.levels.estop_b_closed;
    if (!panel.read) unread_ms_ = unread_ms(panel);
    if (found && !found_)
      told_ms_ = panel.read || panel.age_us < 0 ? kNotYetSeenReleased : unread_ms_;
    else if (found && told_ms_ > 0 && panel.read)
      told_ms_ = std::max(told_ms_, unread_ms_);
    if (found && panel.read && open) told_ms_ = kSeenPressed;
    found_ = found;
    return told_ms_;
  }

 private:
  static std::int32_t unread_ms(const digital_io::PanelReading& panel) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(panel.age_us / 1000, 1, INT32_MAX));
  }

  bool found_ = false;
  std::int32_t told_ms_ = kNotYetSeenReleased;
  std::int32_t unread_ms_ = 0;  // by the last reading that did not come
};

// A hazard for people. `panel_unread_ms`: of the decision that names it.
inline std::string hazard_text(safety::Hazard hazard, std::int32_t panel_unread_ms) {
  if (hazard != safety::Hazard::EStop) return std::string(safety::name_of(hazard));
  if (panel_unread_ms < 0) return "H-25 emergency stop not yet seen released since the supervisor started";
  if (panel_unread_ms == kSeenPressed) return "H-25 emergency stop pressed";
  return fmt::format(
      "H-25 emergency stop unread, not seen pressed: the panel was not read for at least {} ms ({} ms are "
      "allowed); Reset to go on",
      panel_unread_ms, safety::kPanelRead_us / 1000);
}

}  // namespace biopsy::robot
