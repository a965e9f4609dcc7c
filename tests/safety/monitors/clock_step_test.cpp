// Differences of clocks, to the ends of their type.
#include "safety/monitors/clock_step.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

constexpr std::int64_t kFirst_us = std::numeric_limits<std::int64_t>::min(),
                       kLast_us = std::numeric_limits<std::int64_t>::max();

TEST(ClockStep, IsAheadByLessThanALimitAndNeverBehind) {
  verifies("R-05");
  EXPECT_TRUE(is_less_than_after(5, 5, 1));
  EXPECT_FALSE(is_less_than_after(5, 5, 0));
  EXPECT_FALSE(is_less_than_after(5, 5, -1)) << "nothing is less than nothing after";
  EXPECT_TRUE(is_less_than_after(5, 6, 2));
  EXPECT_FALSE(is_less_than_after(5, 6, 1));
  EXPECT_FALSE(is_less_than_after(5, 4, 10));
  EXPECT_TRUE(is_less_than_after(kFirst_us, kFirst_us + 1, 2));
  EXPECT_FALSE(is_less_than_after(kFirst_us, kLast_us, kLast_us)) << "all of time lies between";
  EXPECT_FALSE(is_less_than_after(kLast_us, kFirst_us, 2)) << "a clock that ran over its end";
}

TEST(ClockStep, OfASoundClockIsOneMicrosecondToFiveMilliseconds) {
  verifies("R-05");
  for (const std::int64_t step_us : {-1, 0, 1, 5'000, 5'001})
    EXPECT_EQ(is_sound_step(700, 700 + step_us), step_us == 1 || step_us == 5'000) << step_us;
  EXPECT_FALSE(is_sound_step(kLast_us, kFirst_us));
}

}  // namespace
}  // namespace biopsy::safety
