// Latent faults: contacts, keys, relay and timers that fail unnoticed until they are needed. What the
// contacts do is written from a wiring diagram (two break contacts, one make contact, one relay with a
// feedback contact), tick by tick.
#include "safety/monitors/panel_monitor.hpp"

#include <gtest/gtest.h>

#include "safety/monitors/panel_filter.hpp"
#include "safety/types/transitions.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

using Test = PanelMonitor::Test;

struct PanelBench {
  PanelMonitor monitor;
  SupervisorInputs seen;
  PanelFindings findings;
  bool answers = true;

  // In a state in which both sides feed the interlock.
  explicit PanelBench(Mode mode = Mode::Ready) {
    seen.now_us = 1'000'000;
    seen.panel_read = seen.estop_a_closed = seen.estop_b_closed = true;
    seen.permit.mode = mode;
    seen.relay_closed = mode == Mode::Ready || hv_permitted(mode);
  }
  void tick(int count = 1) {
    for (int i = 0; i < count; ++i) seen.now_us += 1'000, findings = update(monitor, seen, answers);
  }
  void contacts(bool a, bool b) { seen.estop_a_closed = a, seen.estop_b_closed = b; }
  void turn() {
    seen.local_reset = true, tick();
    seen.local_reset = false, tick();
  }
  void test() { tick(), contacts(false, false), tick(), contacts(true, true), tick(), turn(); }
  bool names(Hazard hazard) const { return (findings.found & bit(hazard)) != 0; }
};

TEST(PanelMonitor, IsUntestedUntilBothContactsWereSeenOpenBetweenClosedAndTheResetKeyWasTurned) {
  verifies("R-66");
  PanelBench bench;
  bench.tick(3);
  EXPECT_EQ(bench.findings.found, bit(Hazard::PanelUntested));
  bench.turn();
  EXPECT_TRUE(bench.names(Hazard::PanelUntested)) << "a key alone";
  bench.contacts(false, false), bench.tick();
  EXPECT_TRUE(bench.names(Hazard::EStop));
  bench.turn();
  EXPECT_TRUE(bench.names(Hazard::EStop)) << "reset while pressed";
  bench.contacts(true, true), bench.tick(1'000);
  EXPECT_EQ(bench.findings.found, bit(Hazard::EStop) | bit(Hazard::PanelUntested)) << "released, not reset";
  bench.seen.local_reset = true, bench.tick();
  EXPECT_EQ(bench.findings.found, 0U);
  EXPECT_TRUE(bench.findings.reset);
  bench.tick();
  EXPECT_FALSE(bench.findings.reset) << "once";
}

TEST(PanelMonitor, OneContactThatNeverOpensIsNoTest) {
  verifies("R-66");
  for (const bool a_is_stuck : {true, false}) {
    PanelBench bench;
    bench.tick();
    bench.contacts(a_is_stuck, !a_is_stuck), bench.tick(10);
    bench.contacts(true, true), bench.tick(), bench.turn();
    EXPECT_EQ(bench.findings.found, bit(Hazard::PanelUntested))
        << "pressed and released, and one did nothing";
  }
}

// A contact that was never seen closed may be a wire that is cut: opening proves nothing of it.
TEST(PanelMonitor, ContactsThatWereNotBothClosedFirstAreNotTested) {
  verifies("R-66");
  for (const auto& [a, b] : {std::pair{false, false}, {true, false}, {false, true}}) {
    PanelBench bench;
    bench.contacts(a, b), bench.tick(5);
    bench.contacts(false, false), bench.tick();
    bench.contacts(true, true), bench.tick(), bench.turn();
    EXPECT_EQ(bench.findings.found, bit(Hazard::PanelUntested)) << a << b;
    bench.test();
    EXPECT_EQ(bench.findings.found, 0U) << "once they were";
  }
}

TEST(PanelMonitor, ATurnOfTheKeyResetsWhereTheButtonWasReleasedAndAReleaseDoesNot) {
  verifies("R-03");
  PanelBench bench;
  bench.test();
  const auto resets = [&](bool button_down, bool key_down) {
    bench.contacts(!button_down, !button_down), bench.seen.local_reset = key_down, bench.tick();
    return bench.findings.reset;
  };
  EXPECT_FALSE(resets(false, true)) << "there is nothing to reset";
  EXPECT_FALSE(resets(false, false));
  EXPECT_FALSE(resets(true, false)) << "pressed";
  EXPECT_FALSE(resets(true, true)) << "turned while it is pressed";
  EXPECT_FALSE(resets(false, true)) << "released while the key is held";
  EXPECT_FALSE(resets(false, false)) << "released";
  EXPECT_TRUE(resets(false, true));
}

TEST(PanelMonitor, APanelThatCannotBeReadCountsAsPressedAndIsNoTest) {
  verifies("R-03", "R-66");
  PanelBench bench;
  bench.tick();
  bench.seen.panel_read = false, bench.contacts(false, false), bench.tick();
  EXPECT_TRUE(bench.names(Hazard::EStop));
  bench.seen.panel_read = true, bench.contacts(true, true), bench.tick(), bench.turn();
  EXPECT_EQ(bench.findings.found, bit(Hazard::PanelUntested));
}

// The arm key's contact is proven by the same press: a welded one passes no test.
TEST(PanelMonitor, AnArmKeyThatIsTurnedLeavesThePanelUntested) {
  verifies("R-66");
  PanelBench bench;
  bench.seen.local_arm = true, bench.test();
  EXPECT_TRUE(bench.names(Hazard::PanelUntested));
  bench.seen.local_arm = false, bench.test();
  EXPECT_EQ(bench.findings.found, 0U);
}

TEST(PanelMonitor, AKeyThatStaysTurnedForTenSecondsWithoutVoltageIsStuckAndVoidsTheTest) {
  verifies("R-66");
  for (bool SupervisorInputs::*const key : {&SupervisorInputs::local_arm, &SupervisorInputs::local_reset}) {
    PanelBench bench;
    bench.test(), bench.tick();
    bench.seen.*key = true, bench.tick(9'999);
    EXPECT_EQ(bench.findings.found, 0U);
    bench.seen.*key = false, bench.tick(), bench.seen.*key = true, bench.tick(9'999);
    EXPECT_EQ(bench.findings.found, 0U) << "another turn";
    bench.tick();
    EXPECT_EQ(bench.findings.found, bit(Hazard::PanelUntested));
    bench.seen.*key = false, bench.tick(1'000);
    EXPECT_TRUE(bench.names(Hazard::PanelUntested))
        << "a contact that lets go after all is not to be trusted";
    bench.test();
    EXPECT_EQ(bench.findings.found, 0U);
  }
}

// A press that lasts while the key is stuck is no test of contacts that were not seen closed since.
TEST(PanelMonitor, AStuckKeyVoidsAPressThatIsStillHeld) {
  verifies("R-66");
  PanelBench bench;
  bench.test();
  bench.contacts(false, false), bench.seen.local_arm = true, bench.tick(11'000);
  bench.seen.local_arm = false, bench.tick();
  bench.contacts(true, true), bench.tick(), bench.turn();
  EXPECT_TRUE(bench.names(Hazard::PanelUntested));
  bench.test();
  EXPECT_EQ(bench.findings.found, 0U);
}

TEST(PanelMonitor, AKeyIsStuckAfterTenSecondsToTheMicrosecond) {
  verifies("R-66");
  for (const auto& [turned_us, is_stuck] : {std::pair{9'999'999, false}, {10'000'000, true}}) {
    PanelBench bench;
    bench.test();
    bench.seen.local_arm = true, bench.seen.now_us += turned_us;
    bench.findings = update(bench.monitor, bench.seen, true);
    bench.findings = update(bench.monitor, bench.seen, true);
    EXPECT_EQ(bench.names(Hazard::PanelUntested), is_stuck) << turned_us;
  }
}

// Whoever leaves the key turned while the needle moves has ten seconds after it.
TEST(PanelMonitor, AKeyThatStaysTurnedUnderVoltageVoidsNothing) {
  verifies("R-66");
  for (const Mode mode : {Mode::Armed, Mode::Active, Mode::Hold, Mode::Retract}) {
    PanelBench bench;
    bench.test();
    bench.seen.permit.mode = mode, bench.seen.local_arm = true, bench.tick(60'000);
    bench.seen.permit.mode = Mode::Ready, bench.tick(9'999);
    EXPECT_EQ(bench.findings.found, 0U) << name_of(mode);
    bench.tick();
    EXPECT_EQ(bench.findings.found, bit(Hazard::PanelUntested)) << name_of(mode);
  }
}

TEST(PanelMonitor, AKeyThatWasTurnedSinceTheStartResetsNothing) {
  verifies("R-66");
  PanelBench bench;
  bench.seen.local_reset = true;
  bench.tick(), bench.contacts(false, false), bench.tick(), bench.contacts(true, true), bench.tick(1'000);
  EXPECT_TRUE(bench.names(Hazard::PanelUntested));
}

TEST(PanelMonitor, AnyPressIsLatchedInEveryStateUntilTheResetKeyIsTurned) {
  verifies("R-03");
  for (const Mode mode : {Mode::Boot, Mode::Safe, Mode::Ready, Mode::Armed, Mode::Active, Mode::Hold,
                          Mode::Retract, Mode::Trip, Mode::Lock})
    for (const bool both : {true, false}) {
      PanelBench bench(mode);
      bench.test();
      ASSERT_EQ(bench.findings.found, 0U) << name_of(mode);
      bench.contacts(!both, false), bench.tick();
      bench.contacts(true, true), bench.tick(20);
      EXPECT_TRUE(bench.names(Hazard::EStop)) << name_of(mode);
      bench.turn();
      EXPECT_EQ(bench.findings.found, 0U) << name_of(mode);
    }
}

TEST(PanelMonitor, ATestHoldsForADayAndDoesNotRunOutUnderVoltage) {
  verifies("R-66");
  PanelBench bench;
  bench.test();
  bench.seen.now_us = bench.monitor.tested_us + kPanelTest_us - 1'001, bench.tick();
  EXPECT_EQ(bench.findings.found, 0U);
  bench.seen.permit.mode = Mode::Active, bench.tick(5);
  EXPECT_EQ(bench.findings.found, 0U);
  bench.seen.permit.mode = Mode::Ready, bench.tick();
  EXPECT_EQ(bench.findings.found, bit(Hazard::PanelUntested));
  bench.test();
  EXPECT_EQ(bench.findings.found, 0U);
}

TEST(PanelMonitor, EStopContactsMayDifferForTwentyTicks) {
  verifies("R-04");
  for (const bool a_opens : {true, false}) {
    PanelBench bench;
    bench.test();
    bench.contacts(!a_opens, a_opens), bench.tick(20);
    EXPECT_EQ(bench.findings.found, bit(Hazard::EStop));
    bench.tick();
    EXPECT_EQ(bench.findings.found, bit(Hazard::EStop) | bit(Hazard::EStopDisagrees));
    bench.contacts(true, true), bench.tick(), bench.turn();
    EXPECT_EQ(bench.findings.found, bit(Hazard::EStopDisagrees)) << "until both were seen open";
    bench.contacts(false, false), bench.tick(2), bench.contacts(true, true), bench.tick(), bench.turn();
    EXPECT_EQ(bench.findings.found, 0U);
  }
}

TEST(PanelMonitor, EStopContactsThatAgreeAgainInTimeStartTheCountAnew) {
  verifies("R-04");
  PanelBench bench;
  bench.test();
  for (int round = 0; round < 3; ++round) {
    bench.contacts(false, true), bench.tick(20);
    bench.contacts(true, true), bench.tick();
    EXPECT_FALSE(bench.names(Hazard::EStopDisagrees));
  }
}

TEST(PanelMonitor, ARelayThatIsNotWhereItsPulsesPutItIsNamedAfterThirtyTicks) {
  verifies("R-65");
  for (const Mode mode : {Mode::Boot, Mode::Safe, Mode::Ready, Mode::Armed, Mode::Active, Mode::Hold,
                          Mode::Retract, Mode::Trip, Mode::Lock}) {
    PanelBench bench(mode);
    bench.test();
    bench.seen.relay_closed = !bench.seen.relay_closed;
    bench.tick(30);
    EXPECT_EQ(bench.findings.found, 0U) << name_of(mode);
    bench.tick();
    EXPECT_EQ(bench.findings.found, bit(Hazard::InterlockStuck)) << name_of(mode);
    bench.seen.relay_closed = !bench.seen.relay_closed;
    bench.tick();
    EXPECT_EQ(bench.findings.found, 0U) << name_of(mode);
  }
}

TEST(PanelMonitor, TheDriversTimerIsProvenByARelayThatStaysOpenWhileTheStageAnswersInBoot) {
  verifies("R-65");
  PanelBench bench(Mode::Boot);
  bench.answers = false, bench.tick(100);
  EXPECT_FALSE(bench.findings.interlock_opens)
      << "a stage that does not answer may not have heard that it is to wait";
  bench.answers = true, bench.tick(29);
  EXPECT_FALSE(bench.findings.interlock_opens);
  bench.seen.relay_closed = true, bench.tick(), bench.seen.relay_closed = false, bench.tick(29);
  EXPECT_FALSE(bench.findings.interlock_opens) << "it closed in between";
  bench.tick();
  EXPECT_TRUE(bench.findings.interlock_opens);
}

// A contact of a key as an oscilloscope shows it: bounces for some milliseconds, then closed; and a spike.
TEST(PanelFilter, TakesAContactForClosedAfterTwentyMillisecondsWithoutABreakAndForOpenAtOnce) {
  verifies("R-03");
  ContactFilter filter;
  for (const bool contact : {true, false, true, true, false}) EXPECT_FALSE(is_closed(filter, contact));
  for (int i = 0; i < 19; ++i) EXPECT_FALSE(is_closed(filter, true)) << i;
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(is_closed(filter, true)) << i;
  EXPECT_FALSE(is_closed(filter, false));
  for (int i = 0; i < 19; ++i) EXPECT_FALSE(is_closed(filter, true)) << i;
  EXPECT_TRUE(is_closed(filter, true));
}

TEST(PanelFilter, AKeyChangesAfterTwentyMillisecondsWithoutABreakEitherWay) {
  verifies("R-66");
  KeyFilter key;
  for (int i = 0; i < 19; ++i) EXPECT_TRUE(is_turned(key, false, true)) << "turned until it was seen open";
  EXPECT_FALSE(is_turned(key, false, true));
  for (const bool contact : {true, false, true, true, false}) EXPECT_FALSE(is_turned(key, contact, true));
  for (int i = 0; i < 19; ++i) EXPECT_FALSE(is_turned(key, true, true)) << i;
  EXPECT_TRUE(is_turned(key, true, true));
  for (int i = 0; i < 19; ++i) EXPECT_TRUE(is_turned(key, false, true)) << "at once: " << i;
  EXPECT_FALSE(is_turned(key, false, true));
  for (int i = 0; i < 19; ++i) EXPECT_FALSE(is_turned(key, true, true)) << "and back: " << i;
  EXPECT_TRUE(is_turned(key, true, true));
  for (const bool contact : {false, true, false, false, true}) EXPECT_TRUE(is_turned(key, contact, true));
}

// Reported: a key welded since the start armed at the first break of a millisecond, or when the panel was
// read again.
TEST(PanelFilter, AStuckKeyMakesNoTurnOfABreakNorOfAPanelThatIsReadAgain) {
  verifies("R-66");
  for (const int away_ms : {1, 5, 19})
    for (const bool read : {true, false}) {
      KeyFilter key;
      for (int i = 0; i < 100; ++i) EXPECT_TRUE(is_turned(key, true, true));
      for (int i = 0; i < away_ms; ++i) EXPECT_TRUE(is_turned(key, false, read));
      for (int i = 0; i < 100; ++i) EXPECT_TRUE(is_turned(key, true, true));
    }
  KeyFilter open{.turned = false};
  for (int i = 0; i < 100; ++i)
    EXPECT_FALSE(is_turned(open, true, false)) << "what is not read is not turned";
  for (int i = 0; i < 19; ++i) EXPECT_FALSE(is_turned(open, true, true));
}

}  // namespace
}  // namespace biopsy::safety
