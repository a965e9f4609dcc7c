// The grid of ticks under stalls that the test makes up, and the real clock once.
#include "robot/live/realtime/tick_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace biopsy::realtime {
namespace {

constexpr std::int64_t kPeriod = 1'000'000, kFirst = 7'000'000;

TEST(TickSchedule, KeepsToItsGridHoweverLateEachWakeIs) {
  TickSchedule schedule(kFirst, kPeriod);
  for (std::int64_t i = 0; i < 1'000; ++i) {
    ASSERT_EQ(schedule.due_ns(), kFirst + i * kPeriod) << "lateness must not add up";
    const Wake wake = schedule.woke(schedule.due_ns() + i % 10 * 50'000);
    EXPECT_EQ(wake.late_ns(), i % 10 * 50'000);
    EXPECT_EQ(wake.missed, 0);
  }
}

TEST(TickSchedule, GoesOnAtTheNextWholePeriodAfterAStallAndSaysHowManyWereMissed) {
  TickSchedule schedule(kFirst, kPeriod);
  const Wake stalled = schedule.woke(kFirst + 3'400'000);
  EXPECT_EQ(stalled.late_ns(), 3'400'000);
  EXPECT_EQ(stalled.missed, 3);
  EXPECT_EQ(schedule.due_ns(), kFirst + 4 * kPeriod);
  const Wake next = schedule.woke(schedule.due_ns());
  EXPECT_EQ(next.late_ns(), 0);
  EXPECT_EQ(next.missed, 0);
  EXPECT_EQ(schedule.due_ns(), kFirst + 5 * kPeriod);
}

TEST(TickSchedule, SkipsATickThatWouldFollowCloserThanAQuarterPeriod) {
  TickSchedule just_in_time(kFirst, kPeriod), too_late(kFirst, kPeriod);
  EXPECT_EQ(just_in_time.woke(kFirst + 750'000).missed, 0);
  EXPECT_EQ(just_in_time.due_ns(), kFirst + kPeriod);
  EXPECT_EQ(too_late.woke(kFirst + 750'001).missed, 1);
  EXPECT_EQ(too_late.due_ns(), kFirst + 2 * kPeriod);
}

TEST(TickSchedule, DoesNotTickTwiceWhenItIsWokenTooSoon) {
  TickSchedule schedule(kFirst, kPeriod);
  EXPECT_EQ(schedule.woke(kFirst - 10'000).missed, 0);
  EXPECT_EQ(schedule.due_ns(), kFirst + kPeriod);
}

// A virtual machine that works for a random time in every tick and stalls now and then.
TEST(TickSchedule, HoldsItsRulesOverRandomStallsAndLongTicks) {
  std::mt19937_64 random(3);
  std::exponential_distribution<double> work(1.0 / 400'000), stall(1.0 / 5'000'000);
  for (const std::int64_t period : {1'000'000L, 500'000L, 333'333L, 7L}) {
    TickSchedule schedule(kFirst, period);
    std::int64_t now = kFirst - period, ticks = 0, missed = 0, before = now - period;
    for (int i = 0; i < 20'000; ++i) {
      now = std::max(now, schedule.due_ns());
      if (i % 50 == 0) now += static_cast<std::int64_t>(stall(random));
      const Wake wake = schedule.woke(now);
      ++ticks, missed += wake.missed;
      ASSERT_GE(4 * (wake.woke_ns - before), period) << "two ticks in a burst";
      ASSERT_EQ(schedule.due_ns(), kFirst + (ticks + missed) * period) << "every period is a tick or a miss";
      ASSERT_GT(schedule.due_ns(), now);
      ASSERT_LE(schedule.due_ns() - now, period + period / 4 + 1) << "later than need be";
      before = now;
      now += static_cast<std::int64_t>(work(random));
    }
    EXPECT_GT(missed, 0);
  }
}

TEST(TickClock, TicksInRealTimeAndCountsWhatAStallTook) {
  TickClock clock(std::chrono::milliseconds(1));
  std::int64_t ticks = 0, missed = 0;
  for (; ticks < 20; ++ticks) missed += clock.wait().missed;
  for (const std::int64_t stall_ns = monotonic_ns(); monotonic_ns() - stall_ns < 5 * kPeriod;) {
  }
  const Wake late = clock.wait();
  missed += late.missed;
  EXPECT_GE(late.missed, 3);
  EXPECT_EQ(clock.missed(), missed);
  const Wake next = clock.wait();
  EXPECT_EQ(next.due_ns, late.due_ns + (late.missed + 1) * kPeriod);
  EXPECT_GE(next.woke_ns, next.due_ns) << "never before it is due";
}

}  // namespace
}  // namespace biopsy::realtime
