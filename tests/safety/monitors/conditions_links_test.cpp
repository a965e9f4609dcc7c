// What connects the parts, condition by condition: reports of the gate itself, things that come late, out of
// order or from a part that was restarted.
#include <gtest/gtest.h>

#include "safety/challenge.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

bool names(const Rig& rig, Hazard hazard) {
  return (rig.evidence.hazards() & bit(hazard)) != 0;
}

TEST(GateReports, OfAClockThatJumpedStopTheDriveThoughOurOwnClockIsSound) {
  verifies("R-05");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_measurement = [](Measurement& m) { m.verdict = GateVerdict::ClockJump; };
  rig.tick();
  EXPECT_EQ(rig.state.reason, Hazard::ClockJump);
  EXPECT_EQ(rig.state.mode, Mode::Trip);
}

TEST(GateReports, OfASecondWriterStopTheDriveThoughWeCountOnlyOne) {
  verifies("R-11");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_measurement = [](Measurement& m) { m.verdict = GateVerdict::SecondWriter; };
  rig.tick();
  EXPECT_EQ(rig.state.reason, Hazard::SecondWriter);
  EXPECT_EQ(rig.state.mode, Mode::Trip);
}

TEST(LogBacklog, ThatIsNegativeIsNoGoodNews) {
  verifies("R-28");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_observation = [](SupervisorInputs& seen) { seen.log_backlog_ms = -1; };
  rig.tick();
  EXPECT_EQ(rig.state.reason, Hazard::LogBacklog);
}

TEST(Measurements, ThatComeLateAreCountedAndNotUsed) {
  verifies("R-26");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  const HazardSet before = rig.evidence.hazards();
  const Measurement late = rig.measurement;
  rig.run(1);
  rig.on_measurement = [late](Measurement& m) {
    m = late;
    m.monitor_mV = m.depth_um = 100'000'000;  // nonsense that would be named if it were looked at
  };
  rig.tick();
  EXPECT_EQ(rig.evidence.hazards(), before);
  EXPECT_GT(rig.memory.link.order_score, 0);
  rig.tick();
  EXPECT_TRUE(names(rig, Hazard::MessageOrder));
}

TEST(Measurements, OfARestartedStageAreNotBelievedWhileTheDriveMayBeOn) {
  verifies("R-18");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_measurement = [old = rig.measurement](Measurement& m) { m = old; };
  ASSERT_LE(rig.ticks_until([&] { return rig.state.mode == Mode::Retract; }, 10), 10);
  rig.measurement.seq = 0;  // counts from 1 again
  rig.on_measurement = [](Measurement&) {};
  while (hv_permitted(rig.output.permit.mode)) {
    rig.tick();
    EXPECT_TRUE(names(rig, Hazard::SensorStale)) << name_of(rig.state.mode);
  }
  EXPECT_EQ(rig.state.mode, Mode::Trip) << "a ramp that nobody sees end is not trusted";
  rig.tick();
  EXPECT_FALSE(names(rig, Hazard::SensorStale)) << "with the drive off it is taken up";
}

TEST(Challenge, AnAnswerOlderThanTheLastOneIsWrongThoughItWasRightOnce) {
  verifies("R-10");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.flip_ticks = 1'000'000;  // one voltage, so that nothing but the age tells the answers apart
  rig.run(10);
  Measurement older;
  rig.on_measurement = [&](Measurement& m) { older = m; };
  rig.run(1);
  rig.on_measurement = [](Measurement&) {};
  rig.run(1);
  rig.on_measurement = [&](Measurement& m) {
    m.answer = older.answer, m.answered_seq = older.answered_seq, m.command_mV = older.command_mV;
  };
  ASSERT_EQ(rig.memory.link.answer_score, 0);
  rig.tick();
  EXPECT_EQ(rig.memory.link.answer_score, 2);
}

TEST(Controller, ThatWasRestartedIsTakenUpOnceItWasSilentAndTheDriveIsOff) {
  verifies("R-25");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.on_observation = [old = rig.request](SupervisorInputs& seen) { seen.request = old; };
  rig.run(10);
  ASSERT_TRUE(names(rig, Hazard::ControllerSilent));
  rig.request.seq = 0;
  rig.on_observation = [](SupervisorInputs&) {};
  rig.run(2);
  EXPECT_FALSE(names(rig, Hazard::ControllerSilent));
}

TEST(Controller, ThatCountsBackwardsWithoutHavingBeenSilentIsSilentToUs) {
  verifies("R-25");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.request.seq = 0;
  EXPECT_LE(rig.ticks_until([&] { return names(rig, Hazard::ControllerSilent); }, 10), 5);
}

TEST(Controller, ThatIsRestartedUnderVoltageIsNotTakenUp) {
  verifies("R-25");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  SupervisorInputs seen;
  rig.on_observation = [&](SupervisorInputs& s) { seen = s; };
  rig.tick();
  LinkMonitor watch = rig.memory.link;
  watch.silent_ticks = 100;
  seen.request.seq = 1;
  ++seen.measurement.seq;
  EXPECT_NE(update(rig.plan, watch, seen).found & bit(Hazard::ControllerSilent), 0U);
  seen.permit.mode = Mode::Trip;
  ++seen.measurement.seq;
  EXPECT_EQ(update(rig.plan, watch, seen).found & bit(Hazard::ControllerSilent), 0U);
}

TEST(Controller, DoesNotMissPeriodsByBeingRestarted) {
  verifies("R-24");
  Rig rig;
  rig.request.overruns = 1'000;
  ASSERT_TRUE(rig.go_ready());
  rig.on_observation = [old = rig.request](SupervisorInputs& seen) { seen.request = old; };
  rig.run(10);
  rig.request.seq = rig.request.overruns = 0;
  rig.on_observation = [](SupervisorInputs&) {};
  rig.run(5);
  EXPECT_FALSE(names(rig, Hazard::ControllerSilent));
  EXPECT_FALSE(names(rig, Hazard::LoopOverrun));
}

TEST(Controller, ThatMissesThreePeriodsInOneRequestStopsAtOnceAndIsForgivenAfterTwoHundredTicks) {
  verifies("R-24");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.request.overruns += 3;
  rig.tick();
  EXPECT_EQ(rig.state.reason, Hazard::LoopOverrun);
  EXPECT_EQ(rig.state.mode, Mode::Retract);
  EXPECT_EQ(rig.ticks_until([&] { return !names(rig, Hazard::LoopOverrun); }, 1'000), 200);
}

TEST(Stage, ThatDoesNotHoldItsRateIsStoppedWithAVoltageRamp) {
  verifies("R-24");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_measurement = [late = std::int64_t{0}](Measurement& m) mutable { m.time_us += late += 800; };
  EXPECT_LE(rig.ticks_until([&] { return rig.state.reason == Hazard::LoopOverrun; }, 10), 3);
  EXPECT_EQ(rig.state.mode, Mode::Retract);
}

TEST(Controller, ThatClaimsToHaveMissedBillionsIsStoppedAsOneThatMissedThree) {
  verifies("R-24");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.request.overruns -= 1;  // wraps round: 2^32 - 1 more than before
  rig.tick();
  EXPECT_EQ(rig.state.reason, Hazard::LoopOverrun);
}

}  // namespace
}  // namespace biopsy::safety
