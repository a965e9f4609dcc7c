// How long high voltage may stand after an event, on a machine that may stand still.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/robot/live/host_watch.hpp"
#include "tests/robot/live/live_events.hpp"
#include "tests/robot/live/steady_host.hpp"

namespace biopsy::live_tests {

constexpr double kUnpermitted_ms = 20.0;  // safety concept: HV off 20 ms after the supervisor's last pulse

// Claims that 0 V came in time, and that no voltage stood without a permit. A time that is exceeded while the
// machine itself stood still in it is nobody's: then says so, and it is to be measured again.
inline std::string in_time(const EventOutcome& outcome, double allowed_ms) {
  const std::string text =
      fmt::format("{}: 0 V after {:.2f} ms, the machine being late by {:.2f} ms meanwhile", kNotInTime,
                  outcome.to_zero_ms, outcome.host_late_ms);
  const bool over = outcome.to_zero_ms > allowed_ms || outcome.unpermitted_ms > kUnpermitted_ms;
  if (over && outcome.host_late_ms > kSteady_ms) return text;
  EXPECT_LE(outcome.to_zero_ms, allowed_ms) << text;
  EXPECT_LE(outcome.unpermitted_ms, kUnpermitted_ms) << "voltage without a permit; " << text;
  return {};
}

}  // namespace biopsy::live_tests
