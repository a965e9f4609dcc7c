// A button that acts only while it is held, whatever happens between the hand and the server.
#include "robot/console/server/hold_to_run.hpp"

#include <gtest/gtest.h>

namespace biopsy::console {
namespace {

constexpr std::uint32_t kFirst = 1000;
constexpr std::int64_t kBeat_us = 25'000;

// A page that presses at once and beats on; its clock started somewhere else.
struct Held {
  explicit Held(double page_starts_ms = 5'000.0) : page_ms(page_starts_ms) {
    EXPECT_TRUE(button.press(token, page_ms, now_us));
  }
  void beats(int count, std::int64_t every_us = kBeat_us) {
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

TEST(HoldToRun, LastsAsLongAsItBeats) {
  Held person;
  person.beats(400);
  EXPECT_EQ(person.button.held(person.now_us), kFirst);
  EXPECT_EQ(person.button.held_for_us(person.now_us), 10'000'000);
}

TEST(HoldToRun, ASilentPageHoldsNothing) {
  Held person;
  person.beats(10);
  EXPECT_TRUE(person.button.held(person.now_us + kBeatMax_us));
  EXPECT_FALSE(person.button.held(person.now_us + kBeatMax_us + 1));
}

TEST(HoldToRun, LateBeatsOfAFrozenPageDoNotPressAgain) {
  Held person;
  person.beats(10);
  person.now_us += 700'000;  // frozen: what its timers owed comes at once
  for (int n = 0; n < 28; ++n) {
    person.page_ms += 25.0;
    person.button.beat(person.token, person.page_ms, person.now_us + n);
  }
  EXPECT_FALSE(person.button.held(person.now_us + 30));
}

TEST(HoldToRun, BeatsThatWereLongOnTheirWayEndThePress) {
  Held person;
  person.beats(10);
  // A link that fills up: each arrives in time after the last, and is older than the last.
  for (int n = 0; n < 10; ++n) {
    person.now_us += 60'000;
    person.page_ms += 25.0;
    person.button.beat(person.token, person.page_ms, person.now_us);
  }
  EXPECT_FALSE(person.button.held(person.now_us));
}

TEST(HoldToRun, ATokenIsAcceptedOnce) {
  Held person;
  person.button.release(person.token);
  EXPECT_FALSE(person.button.press(person.token, person.page_ms + 100.0, person.now_us));
  EXPECT_TRUE(person.button.press(person.token + 1, person.page_ms + 100.0, person.now_us));
  EXPECT_FALSE(HoldToRun(kFirst).press(kFirst + 7, 0.0, 0));
}

TEST(HoldToRun, ASecondPressWhileHeldIsRefused) {
  Held person;
  EXPECT_FALSE(person.button.press(person.button.next_token(), person.page_ms, person.now_us));
  person.beats(1);
  EXPECT_EQ(person.button.held(person.now_us), kFirst);
}

TEST(HoldToRun, AClockOfThePageThatIsWrongByHoursChangesNothing) {
  for (const double skew_ms : {0.0, 1.0, 7.2e6, 1e11}) {
    Held person(skew_ms);
    person.beats(100);
    EXPECT_TRUE(person.button.held(person.now_us)) << skew_ms;
    EXPECT_FALSE(person.button.held(person.now_us + kBeatMax_us + 1)) << skew_ms;
  }
}

TEST(HoldToRun, APageWhoseClockGoesBackHoldsNothing) {
  Held person;
  person.button.beat(person.token, person.page_ms - 1.0, person.now_us + 1);
  EXPECT_FALSE(person.button.held(person.now_us + 1));
}

}  // namespace
}  // namespace biopsy::console
