// The counters of the monitors at their ends. Inputs: every count there is, and the definitions in words.
#include "safety/monitors/debounce.hpp"

#include <gtest/gtest.h>

#include <initializer_list>
#include <utility>

#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

TEST(Debounce, CountsInARowUpToItsLimitAndForgetsAllAtOnce) {
  for (int count = 0; count <= 5; ++count) {
    EXPECT_EQ(debounced(count, true, 5), count == 5 ? 5 : count + 1);
    EXPECT_EQ(debounced(count, false, 5), 0);
  }
}

TEST(Debounce, AccumulatesItsWeightUpToSoManyInARowAndForgetsOneByOneDownToNothing) {
  for (const auto& [weight, ticks] : {std::pair{2, 3}, {2, 2}, {4, 10}}) {
    const int trip = weight * ticks;
    for (int score = 0; score <= trip; ++score) {
      EXPECT_EQ(accumulated(score, true, weight, ticks), score + weight > trip ? trip : score + weight);
      EXPECT_EQ(accumulated(score, false, weight, ticks), score == 0 ? 0 : score - 1);
    }
  }
}

// A thousand sound samples are no better than none: what comes after them takes as many bad ones.
TEST(Debounce, SoundSamplesLeaveNothingBehind) {
  std::int32_t score = 0;
  for (int i = 0; i < 1'000; ++i) score = accumulated(score, false, 2, 3);
  for (const bool bad : {true, true, false, true}) score = accumulated(score, bad, 2, 3);
  EXPECT_LT(score, 6) << "three bad ones, but a sound one among them";
}

TEST(Debounce, ErrorCounterForgivesOneAndNamesASecondThatComesSoon) {
  verifies("R-10");
  const auto after = [](std::initializer_list<bool> rights) {
    std::int32_t score = 0;
    for (const bool right : rights) score = error_counter(score, right);
    return score;
  };
  EXPECT_EQ(after({true, true}), 0);
  EXPECT_EQ(after({false}), 2);
  EXPECT_EQ(after({false, true, false}), 3) << "above 2: named";
  EXPECT_EQ(after({false, true, true, false}), 2);
  EXPECT_EQ(after({false, false, false}), 4) << "no more than that to forget";
}

TEST(Debounce, AHazardIsInTheSetWhereItsConditionHolds) {
  EXPECT_EQ(when(true, Hazard::Arc), bit(Hazard::Arc));
  EXPECT_EQ(when(false, Hazard::Arc), 0U);
}

}  // namespace
}  // namespace biopsy::safety
