// The independent interlock as hardware must build it: two retriggerable timers in series, one fed by the
// supervisor, one by the driver; HV is enabled only while both were fed within 20 ms. Modelled here so that
// tests and the live simulation share one specification. Runs as its own process (or relay), on its own
// clock.
#pragma once

#include <cstdint>

#include "safety/monitors/clock_step.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::safety {

// Default-constructed: never fed, so it is open.
struct Interlock {
  bool fed_by_supervisor = false, fed_by_driver = false;  // ever
  std::int64_t supervisor_us = 0, driver_us = 0;          // when last
};

constexpr Interlock feed_from_supervisor(Interlock interlock, std::int64_t now_us) {
  interlock.fed_by_supervisor = true;
  interlock.supervisor_us = now_us;
  return interlock;
}
constexpr Interlock feed_from_driver(Interlock interlock, std::int64_t now_us) {
  interlock.fed_by_driver = true;
  interlock.driver_us = now_us;
  return interlock;
}

// Whether HV may be enabled now. A time before the last feeding counts as too late: the clock is wrong.
constexpr bool is_closed(const Interlock& interlock, std::int64_t now_us) {
  const auto live = [now_us](bool fed, std::int64_t fed_us) {
    return fed && is_less_than_after(fed_us, now_us, kInterlock_us);
  };
  return live(interlock.fed_by_supervisor, interlock.supervisor_us) &&
         live(interlock.fed_by_driver, interlock.driver_us);
}

}  // namespace biopsy::safety
