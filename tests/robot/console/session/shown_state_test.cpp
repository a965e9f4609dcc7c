#include "robot/console/shown_state.hpp"

#include <gtest/gtest.h>

namespace biopsy::robot {
namespace {

using console::events::State;
using Due = ShownState::Due;

constexpr std::int64_t kStep_us = 20'000;

// How many are sent in this time, asked every 20 ms as the console does.
template <class StateAt>
int sent_in(std::int64_t lasts_us, StateAt state_at) {
  ShownState sent;
  sent.note(state_at(0.0), 0);
  int count = 0;
  for (std::int64_t now_us = kStep_us; now_us <= lasts_us; now_us += kStep_us) {
    State state = state_at(1e-6 * static_cast<double>(now_us));
    state.seq = static_cast<std::uint32_t>(now_us);
    if (sent.due(state, now_us) == Due::No) continue;
    sent.note(state, now_us);
    ++count;
  }
  return count;
}

constexpr std::int64_t kTenSeconds_us = 10'000'000;

TEST(ShownState, OfARobotThatWaitsIsSentTwiceASecond) {
  EXPECT_EQ(sent_in(kTenSeconds_us, [](double) { return State{}; }), 20);
  EXPECT_EQ(sent_in(kTenSeconds_us,
                    [](double at_s) {  // the noise of its depth
                      State state{};
                      state.depth = 0.004 * std::sin(1000.0 * at_s);
                      return state;
                    }),
            20);
}

// For a quarter of an hour after an accepted depth.
TEST(ShownState, IsNotSentForTheTimeThatChecksAreCarried) {
  EXPECT_LE(sent_in(kTenSeconds_us,
                    [](double at_s) {
                      State state{};
                      state.carried_left = 890.0 - at_s;
                      return state;
                    }),
            21);
}

TEST(ShownState, CountsSecondsDownAndFollowsAMovingNeedle) {
  EXPECT_GE(sent_in(kTenSeconds_us,
                    [](double at_s) {
                      State state{};
                      state.ticks_left = 59.99 - at_s;
                      return state;
                    }),
            20);
  EXPECT_EQ(sent_in(kTenSeconds_us,
                    [](double at_s) {
                      State state{};
                      state.depth = 0.5 * at_s;
                      return state;
                    }),
            100);
}

TEST(ShownState, TellsWhatLastsAtOnceAndReliably) {
  ShownState sent;
  State state{};
  EXPECT_EQ(sent.due(state, 0), Due::Reliable);
  sent.note(state, 0);
  EXPECT_EQ(sent.due(state, 1), Due::No);
  EXPECT_EQ(sent.due(state, ShownState::kSame_us), Due::BestEffort);
  state.mode = Mode::Trip;
  EXPECT_EQ(sent.due(state, 1), Due::Reliable);
  state.mode = {};
  state.locked = true;
  EXPECT_EQ(sent.due(state, 1), Due::Reliable);
}

}  // namespace
}  // namespace biopsy::robot
