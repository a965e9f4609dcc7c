// Which of its causes H-25 is told with. Inputs: readings of a panel made by hand, tick by tick, and the
// words of the safety concept: an unread panel stops as a press does, and is not one.
#include "robot/cycle/stop_cause.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "robot/cycle/supervise.hpp"

namespace biopsy::robot {
namespace {

using digital_io::PanelReading;

constexpr PanelReading kReleased{
    .levels = {.estop_a_closed = true, .estop_b_closed = true}, .read = true, .age_us = 700};

PanelReading unread(std::int64_t age_us) {
  return {.levels = {}, .read = false, .age_us = age_us};
}

TEST(StopCause, TellsAPressByEitherContact) {
  for (bool digital_io::PanelLevels::*const contact :
       {&digital_io::PanelLevels::estop_a_closed, &digital_io::PanelLevels::estop_b_closed}) {
    StopCause cause;
    PanelReading pressed = kReleased;
    pressed.levels.*contact = false;
    EXPECT_EQ(cause.update(pressed, true), kSeenPressed);
    EXPECT_EQ(cause.update(kReleased, true), kSeenPressed) << "let go, not reset";
    EXPECT_EQ(cause.update(unread(90'000), true), kSeenPressed) << "unread afterwards";
  }
}

// A text that changes at every tick would be a new alarm at every tick.
TEST(StopCause, TellsHowLongAnUnreadPanelWasUnreadOnceItIsReadAgain) {
  StopCause cause;
  (void)cause.update(kReleased, false);
  for (std::int64_t age_us = 20'400; age_us < 143'900; age_us += 1'000)
    EXPECT_EQ(cause.update(unread(age_us), true), 20) << age_us;
  EXPECT_EQ(cause.update(kReleased, true), 143);
  EXPECT_EQ(cause.update(unread(30'000), true), 143);
  EXPECT_EQ(cause.update(kReleased, true), 143) << "a shorter one";
  EXPECT_EQ(cause.update(kReleased, false), 143) << "a trip that outlasts the reset key keeps its reason";
  EXPECT_EQ(cause.update(unread(50'000), true), 50) << "another time";
}

TEST(StopCause, ForgetsALongerTimeOfAnEarlierStop) {
  StopCause cause;
  (void)cause.update(unread(143'900), true);
  (void)cause.update(kReleased, true);
  (void)cause.update(kReleased, false);
  EXPECT_EQ(cause.update(unread(30'000), true), 30);
  EXPECT_EQ(cause.update(kReleased, true), 30);
}

TEST(StopCause, RoundsDownToMillisecondsAndNeverToNone) {
  for (const auto& [age_us, ms] : {std::pair{0, 1}, {999, 1}, {1'999, 1}, {143'990, 143}}) {
    StopCause cause;
    EXPECT_EQ(cause.update(unread(age_us), true), ms) << age_us;
  }
  StopCause longer;
  EXPECT_EQ(longer.update(unread(400), true), 1);
  (void)longer.update(unread(5'400), true);
  EXPECT_EQ(longer.update(kReleased, true), 5);
}

// The age of a reading that came says nothing of one that did not.
TEST(StopCause, CountsNoAgeOfAPanelThatIsRead) {
  StopCause cause;
  PanelReading old = kReleased;
  old.age_us = 90'000;
  EXPECT_EQ(cause.update(unread(21'000), true), 21);
  EXPECT_EQ(cause.update(old, true), 21);
  EXPECT_EQ(cause.update(old, true), 21);
}

TEST(StopCause, APressStaysOneAfterAnUnreadPanel) {
  StopCause cause;
  PanelReading pressed = kReleased;
  pressed.levels.estop_a_closed = false;
  EXPECT_EQ(cause.update(pressed, true), kSeenPressed);
  EXPECT_EQ(cause.update(unread(50'000), true), kSeenPressed);
  EXPECT_EQ(cause.update(kReleased, true), kSeenPressed);
}

TEST(StopCause, APressAfterAnUnreadPanelIsAPress) {
  StopCause cause;
  EXPECT_EQ(cause.update(unread(21'000), true), 21);
  PanelReading pressed = kReleased;
  pressed.levels.estop_b_closed = false;
  EXPECT_EQ(cause.update(pressed, true), kSeenPressed);
  EXPECT_EQ(cause.update(kReleased, true), kSeenPressed);
}

TEST(StopCause, BeforeThePanelWasEverSeenReleasedNothingIsCalledAPress) {
  StopCause never;
  EXPECT_EQ(never.update(PanelReading{}, true), kNotYetSeenReleased);
  EXPECT_EQ(never.update(kReleased, true), kNotYetSeenReleased);
  StopCause filtered;  // both contacts closed, not for long enough
  EXPECT_EQ(filtered.update(kReleased, true), kNotYetSeenReleased);
}

TEST(StopCause, IsCalledWhatItIs) {
  using safety::Hazard;
  EXPECT_EQ(kNotYetSeenReleased, -1) << "on the bus";
  EXPECT_EQ(hazard_text(Hazard::EStop, kSeenPressed), "H-25 emergency stop pressed");
  EXPECT_EQ(hazard_text(Hazard::EStop, 143),
            "H-25 emergency stop unread, not seen pressed: the panel was not read for at least 143 ms (20 ms "
            "are allowed); Reset to go on");
  EXPECT_EQ(hazard_text(Hazard::EStop, kNotYetSeenReleased),
            "H-25 emergency stop not yet seen released since the supervisor started");
  for (const std::int32_t ms : {kNotYetSeenReleased, kSeenPressed, 143})
    EXPECT_EQ(hazard_text(Hazard::Arc, ms), safety::name_of(Hazard::Arc));
}

// The stop itself is the same for both.
TEST(StopCause, AnUnreadPanelIsFoundInTheTickAsAPressIsAndStaysUntilTheResetKey) {
  for (const bool read : {true, false}) {
    SupervisorMemory memory;
    SupervisorSources in;
    const auto tick = [&](const PanelReading& panel) {
      in.now_us += 1'000, in.panel = panel;
      const Supervision now = supervise(in, memory);
      return std::pair{(now.evidence.clear & safety::bit(safety::Hazard::EStop)) == 0, now.panel_unread_ms};
    };
    PanelReading turned = kReleased;
    turned.levels.reset_key = true;
    const auto reset = [&] {
      for (int i = 0; i <= safety::kContact_ticks; ++i) (void)tick(kReleased);
      for (int i = 0; i <= safety::kContact_ticks; ++i) (void)tick(turned);
      return !tick(kReleased).first;
    };
    ASSERT_TRUE(reset());
    const auto [found, told] =
        tick(read ? PanelReading{.levels = {}, .read = true, .age_us = 0} : unread(20'000));
    EXPECT_TRUE(found);
    EXPECT_EQ(told, read ? kSeenPressed : 20);
    for (int i = 0; i < 300; ++i) EXPECT_TRUE(tick(kReleased).first) << "latched";
    EXPECT_TRUE(reset());
  }
}

}  // namespace
}  // namespace biopsy::robot
