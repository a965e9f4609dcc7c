// The judge of a machine that stands still, on wakes made up by hand.
#include "tests/live/host_watch.hpp"

#include <gtest/gtest.h>

namespace biopsy::live_tests {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kAlways = 1'000 * kMs;

TEST(HostWatch, SumsWhatAProcessorWasLateByWithinTheStretch) {
  const std::vector<realtime::Wake> wakes{{.due_ns = 1 * kMs, .woke_ns = 3 * kMs},
                                          {.due_ns = 4 * kMs, .woke_ns = 6 * kMs},
                                          {.due_ns = 50 * kMs, .woke_ns = 53 * kMs}};
  EXPECT_EQ(most_late_ns_within(6 * kMs, wakes, 0, kAlways), 4 * kMs);
  EXPECT_EQ(most_late_ns_within(3 * kMs, wakes, 0, 40 * kMs), 2 * kMs);
  EXPECT_EQ(most_late_ns_within(6 * kMs, wakes, 40 * kMs, kAlways), 3 * kMs);
}

TEST(HostWatch, CountsOnlyThePartOfAStallThatLiesInTheStretch) {
  const std::vector<realtime::Wake> wakes{{.due_ns = 0, .woke_ns = 20 * kMs}};
  EXPECT_EQ(most_late_ns_within(6 * kMs, wakes, 0, kAlways), 6 * kMs);
  EXPECT_EQ(most_late_ns_within(6 * kMs, {}, 0, kAlways), 0);
}

}  // namespace
}  // namespace biopsy::live_tests
