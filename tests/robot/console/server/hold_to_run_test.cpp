#include "robot/console/server/hold_to_run.hpp"

#include <gtest/gtest.h>

#include "tests/safety/verifies.hpp"

namespace biopsy::console {
namespace {

constexpr std::uint32_t kFirst = 1000;
constexpr std::int64_t kBeat_us = 25'000;

// A page that holds the button and sends heartbeats; its clock has another origin.
struct HeldButton {
  explicit HeldButton(double page_starts_ms = 5'000.0) : page_ms(page_starts_ms) {
    EXPECT_TRUE(button.press(token, page_ms, now_us));
  }
  void beat(int count, std::int64_t every_us = kBeat_us) {
    for (int n = 0; n < count; ++n) {
      now_us += every_us;
      page_ms += static_cast<double>(every_us) * 1e-3;
      button.beat(token, page_ms, now_us);
    }
  }
  HoldToRun button{kFirst};
  std::uint32_t token = kFirst;
  std::int64_t now_us = 1'000'000;
  double page_ms;
};

TEST(HoldToRun, LastsWhileHeartbeatsArrive) {
  HeldButton held;
  held.beat(400);
  EXPECT_EQ(held.button.held(held.now_us), kFirst);
  EXPECT_EQ(held.button.held_for_us(held.now_us), 10'000'000);
}

TEST(HoldToRun, EndsWithoutHeartbeats) {
  HeldButton held;
  held.beat(10);
  EXPECT_TRUE(held.button.held(held.now_us + kBeatMax_us));
  EXPECT_FALSE(held.button.held(held.now_us + kBeatMax_us + 1));
}

TEST(HoldToRun, EndsForGoodWhenAFrozenPageCatchesUp) {
  verifies("R-63");
  HeldButton held;
  held.beat(10);
  held.now_us += 700'000;  // frozen: its timers fire late, all at once
  for (int n = 0; n < 28; ++n) {
    held.page_ms += 25.0;
    held.button.beat(held.token, held.page_ms, held.now_us + n);
  }
  EXPECT_FALSE(held.button.held(held.now_us + 30));
}

TEST(HoldToRun, EndsWhenHeartbeatsAreDelayed) {
  HeldButton held;
  held.beat(10);
  // A growing queue: each heartbeat arrives in time after the last, with a larger delay.
  for (int n = 0; n < 10; ++n) {
    held.now_us += 60'000;
    held.page_ms += 25.0;
    held.button.beat(held.token, held.page_ms, held.now_us);
  }
  EXPECT_FALSE(held.button.held(held.now_us));
}

TEST(HoldToRun, AcceptsATokenOnce) {
  verifies("R-63");
  HeldButton held;
  held.button.release(held.token);
  EXPECT_FALSE(held.button.press(held.token, held.page_ms + 100.0, held.now_us));
  EXPECT_TRUE(held.button.press(held.token + 1, held.page_ms + 100.0, held.now_us));
  EXPECT_FALSE(HoldToRun(kFirst).press(kFirst + 7, 0.0, 0));
}

TEST(HoldToRun, RefusesASecondPressWhileHeld) {
  HeldButton held;
  EXPECT_FALSE(held.button.press(held.button.next_token(), held.page_ms, held.now_us));
  held.beat(1);
  EXPECT_EQ(held.button.held(held.now_us), kFirst);
}

TEST(HoldToRun, IsIndependentOfThePagesClock) {
  for (const double skew_ms : {0.0, 1.0, 7.2e6, 1e11}) {
    HeldButton held(skew_ms);
    held.beat(100);
    EXPECT_TRUE(held.button.held(held.now_us)) << skew_ms;
    EXPECT_FALSE(held.button.held(held.now_us + kBeatMax_us + 1)) << skew_ms;
  }
}

TEST(HoldToRun, EndsWhenThePagesClockGoesBack) {
  HeldButton held;
  held.button.beat(held.token, held.page_ms - 1.0, held.now_us + 1);
  EXPECT_FALSE(held.button.held(held.now_us + 1));
}

}  // namespace
}  // namespace biopsy::console
