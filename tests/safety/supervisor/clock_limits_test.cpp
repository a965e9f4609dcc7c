// Limits of time hold on the supervisor's clock, however many ticks it takes: a host that loses ticks does
// not hold longer.
#include <gtest/gtest.h>

#include "safety/monitors/clock_step.hpp"
#include "tests/safety/monitor_bench.hpp"
#include "tests/safety/situation.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

// Milliseconds until a mode ends by itself, with a tick every `dt_us`.
std::int64_t lasts_ms(Mode mode, std::int64_t dt_us, Event by) {
  Moment moment(mode);
  moment.input.motion = {};
  LinkMonitor clock;
  SupervisorInputs seen;
  PlanFacts none;
  for (std::int64_t now_us = dt_us;; now_us += dt_us) {
    seen.now_us = now_us;
    moment.input.evidence.elapsed_ms = update(none, clock, seen).elapsed_ms;
    if (moment.event() == by) return now_us / 1'000;
    if (now_us > 100'000'000) return -1;
    moment.state = moment.next();
  }
}

TEST(ClockLimits, AreThoseOfTheClockWhateverTheTicksAre) {
  verifies("R-05");
  for (const std::int64_t dt_us : {200, 700, 1'000, 1'300, 1'999, 3'600, 4'999}) {
    const double within_ms = 2.0 + 2e-3 * static_cast<double>(dt_us);  // the tick before and the one after
    EXPECT_NEAR(static_cast<double>(lasts_ms(Mode::Hold, dt_us, Event::HoldTooLong)), 10'000, within_ms)
        << dt_us;
    EXPECT_NEAR(static_cast<double>(lasts_ms(Mode::Armed, dt_us, Event::ArmedTooLong)), 30'000, within_ms)
        << dt_us;
    EXPECT_NEAR(static_cast<double>(lasts_ms(Mode::Retract, dt_us, Event::RampTooLong)), 300, within_ms)
        << dt_us;
    EXPECT_NEAR(static_cast<double>(lasts_ms(Mode::Active, dt_us, Event::Stop)), 100, within_ms) << dt_us;
  }
}

TEST(ClockLimits, AClockThatCannotBeTrustedCountsATickForAMillisecond) {
  verifies("R-05");
  LinkMonitor monitor;
  SupervisorInputs seen;
  for (const std::int64_t now_us : {5'000'000LL, 5'000'000LL, 4'000'000LL, 90'000'000LL}) {
    seen.now_us = now_us;
    const LinkFindings findings = update(PlanFacts{}, monitor, seen);
    EXPECT_EQ(findings.elapsed_ms, 1) << now_us;
    EXPECT_NE(findings.found & bit(Hazard::ClockJump), 0U) << now_us;
  }
}

TEST(ClockLimits, NoElapsedTimeShortensATimerOrOverflowsIt) {
  for (const std::int32_t elapsed : {-1'000'000, -1, 0, 1, 6, 7, 2'000'000'000})
    for (const std::int32_t value : {-5, 0, 1, 9'999, 2'000'000'000}) {
      const std::int32_t later = later_ms(value, elapsed, 10'000);
      EXPECT_GE(later, std::clamp(value, 0, 10'000));
      EXPECT_LE(later, 10'000);
    }
}

}  // namespace
}  // namespace biopsy::safety
