// Contacts of keys and buttons bounce, and a wire beside a kilovolt edge picks up spikes: a contact counts as
// closed once it was closed for kContact_ticks without a break, and as open at once. Open is the safe side of
// the emergency stop and of the bench key.
//
// An arm or reset key acts when it is turned. A moment's break must not make a turn of one that is stuck: its
// level changes once its contact was otherwise for kContact_ticks, and it counts as turned until it was seen
// open.
#pragma once

#include <cstdint>

#include "safety/monitors/debounce.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::safety {

// Default-constructed: open.
struct ContactFilter {
  std::int32_t closed_ticks = 0;
};

// The level of this tick.
constexpr bool is_closed(ContactFilter& filter, bool contact) {
  filter.closed_ticks = debounced(filter.closed_ticks, contact, kContact_ticks);
  return filter.closed_ticks >= kContact_ticks;
}

// Default-constructed: turned.
struct KeyFilter {
  bool turned = true;
  std::int32_t other_ticks = 0;
};

// The level of this tick; that of the last one where the panel was not `read`.
constexpr bool is_turned(KeyFilter& filter, bool contact, bool read) {
  filter.other_ticks = debounced(filter.other_ticks, read && contact != filter.turned, kContact_ticks);
  if (filter.other_ticks >= kContact_ticks) filter.turned = contact, filter.other_ticks = 0;
  return filter.turned;
}

// `read`: a panel counts as read once its contacts have had the time to count as closed, so that what was not
// seen is no press.
struct PanelFilter {
  KeyFilter arm, reset;
  ContactFilter read, estop_a, estop_b, bench;
};

}  // namespace biopsy::safety
