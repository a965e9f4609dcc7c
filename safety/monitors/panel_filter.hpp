// Contacts of keys and buttons bounce, and a wire beside a kilovolt edge picks up spikes: a contact counts as
// closed once it was closed for kContact_ticks without a break, and as open at once. Open is the safe side of
// every one of them: no key turned, emergency stop pressed, no bench confirmed.
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

struct PanelFilter {
  ContactFilter arm, reset, estop_a, estop_b, bench;
};

}  // namespace biopsy::safety
