// Links in the loop of supervisor and gate: reports of the gate, messages late or out of order, restarted
// parts.
#include <gtest/gtest.h>

#include "safety/challenge.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

bool names(const Rig& rig, Hazard hazard) {
  return (rig.evidence.hazards() & bit(hazard)) != 0;
}

TEST(SafetyLoop, GateReportsOfAClockJumpOrASecondWriterStopTheDriveThoughOurOwnSightIsSound) {
  verifies("R-05", "R-11");
  for (const auto& [verdict, hazard] : {std::pair{GateVerdict::ClockJump, Hazard::ClockJump},
                                        {GateVerdict::SecondWriter, Hazard::SecondWriter}}) {
    Rig rig;
    ASSERT_TRUE(rig.go_active());
    rig.on_measurement = [verdict = verdict](Measurement& m) { m.verdict = verdict; };
    rig.tick();
    EXPECT_EQ(rig.state.reason, hazard);
    EXPECT_EQ(rig.state.mode, Mode::Trip);
  }
}

TEST(SafetyLoop, MeasurementsThatComeLateAreCountedAndNotUsed) {
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

TEST(SafetyLoop, MeasurementsOfARestartedStageAreNotBelievedWhileTheDriveMayBeOn) {
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

TEST(SafetyLoop, AnswersOneAboveOrBelowTheRightOneAreWrong) {
  verifies("R-10");
  for (const std::uint32_t off : {1U, ~0U}) {
    Rig rig;
    ASSERT_TRUE(rig.go_ready());
    rig.run(10);
    rig.on_measurement = [off](Measurement& m) { m.answer += off; };
    const auto is_wrong = [&] { return (rig.evidence.hazards() & bit(Hazard::WrongAnswer)) != 0; };
    rig.tick();
    EXPECT_FALSE(is_wrong()) << "one slip is forgiven";
    EXPECT_LE(rig.ticks_until(is_wrong, 2), 2);
  }
}

TEST(SafetyLoop, ChallengeAnAnswerOlderThanTheLastOneIsWrongThoughItWasRightOnce) {
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

// Reckoned apart from this code. A driver by somebody else has to give the same answers.
TEST(SafetyLoop, ChallengeAsksAndAnswersWhatADriverBySomebodyElseReckonsToo) {
  verifies("R-10");
  EXPECT_EQ(challenge_of(7, 1), 0x72E7'EF71U);
  EXPECT_EQ(challenge_of(1'700'000'000, 123'456), 0xFE90'5888U);
  EXPECT_EQ(answer_to(0xABCD, -5'000'000, Mode::Active, 77), 0xDD6C'0AACU);
  EXPECT_EQ(answer_to(1, 8'000'000, Mode::Hold, 4'000'000'000), 0x5D40'A7BDU);
}

TEST(SafetyLoop, ChallengeLostPermitsAreForgivenAslongAsTheAnswersAreRight) {
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_permit = [n = 0](Permit&) mutable { return ++n % 4 == 0; };  // three of four lost on the way
  rig.run(500);
  EXPECT_EQ(rig.state.mode, Mode::Active) << name_of(rig.state.reason);
}

// However long: the stage took the voltage off by itself, and did not disobey.
TEST(SafetyLoop, ChallengeAPermitThatExpiredOnTheWayIsADriverThatDoesNotAnswer) {
  verifies("R-09", "R-10");
  for (int lost = 1; lost <= 12; ++lost) {
    Rig rig;
    ASSERT_TRUE(rig.go_active());
    rig.on_permit = [n = 0, lost](Permit&) mutable { return ++n > lost; };
    rig.run(30);
    const bool expired = lost >= limits::kPermitTtl_us / 1'000;
    EXPECT_EQ(rig.state.mode, expired ? Mode::Trip : Mode::Active) << lost;
    EXPECT_EQ(rig.state.reason, expired ? Hazard::WrongAnswer : Hazard::None) << lost;
  }
}

TEST(SafetyLoop, ChallengeADriverThatKeepsGivingAnOldAnswerIsFoundOut) {
  verifies("R-10");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.flip_ticks = 1'000'000;
  rig.on_measurement = [old = rig.measurement](Measurement& m) {
    m.answer = old.answer, m.answered_seq = old.answered_seq, m.command_mV = old.command_mV;
  };
  EXPECT_LE(rig.ticks_until([&] { return (rig.evidence.hazards() & bit(Hazard::WrongAnswer)) != 0; }, 20), 7);
}

TEST(SafetyLoop, ChallengeAnAnswerFromTheFutureIsWrong) {
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_measurement = [&](Measurement& m) {
    m.answered_seq += 1;
    m.answer = answer_to(challenge_of(7, m.answered_seq), m.command_mV, Mode::Active, m.answered_seq);
  };
  EXPECT_LE(rig.ticks_until([&] { return rig.output.worst == Hazard::WrongAnswer; }, 20), 3);
}

TEST(SafetyLoop, ControllerThatWasRestartedIsTakenUpOnceItWasSilentAndTheDriveIsOff) {
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

TEST(SafetyLoop, ControllerThatCountsBackwardsWithoutHavingBeenSilentIsSilentToUs) {
  verifies("R-25");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.request.seq = 0;
  EXPECT_LE(rig.ticks_until([&] { return names(rig, Hazard::ControllerSilent); }, 10), 5);
}

TEST(SafetyLoop, ControllerThatIsRestartedUnderVoltageIsNotTakenUp) {
  verifies("R-25");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  SupervisorInputs seen;
  rig.on_observation = [&](SupervisorInputs& s) { seen = s; };
  rig.tick();
  LinkMonitor monitor = rig.memory.link;
  monitor.silent_ticks = 100;
  seen.request.seq = 1;
  ++seen.measurement.seq;
  EXPECT_NE(update(rig.plan, monitor, seen).found & bit(Hazard::ControllerSilent), 0U);
  seen.permit.mode = Mode::Trip;
  ++seen.measurement.seq;
  EXPECT_EQ(update(rig.plan, monitor, seen).found & bit(Hazard::ControllerSilent), 0U);
}

TEST(SafetyLoop, ControllerDoesNotMissPeriodsByBeingRestarted) {
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

TEST(SafetyLoop, ControllerThatMissesThreePeriodsInOneRequestStopsAtOnceAndIsForgivenAfterTwoHundredTicks) {
  verifies("R-24");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.request.overruns += 3;
  rig.tick();
  EXPECT_EQ(rig.state.reason, Hazard::LoopOverrun);
  EXPECT_EQ(rig.state.mode, Mode::Retract);
  EXPECT_EQ(rig.ticks_until([&] { return !names(rig, Hazard::LoopOverrun); }, 1'000), 200);
}

TEST(SafetyLoop, ControllerThatClaimsToHaveMissedBillionsIsStoppedAsOneThatMissedThree) {
  verifies("R-24");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.request.overruns -= 1;  // wraps round: 2^32 - 1 more than before
  rig.tick();
  EXPECT_EQ(rig.state.reason, Hazard::LoopOverrun);
}

TEST(SafetyLoop, StageThatDoesNotHoldItsRateIsStoppedWithAVoltageRamp) {
  verifies("R-24");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_measurement = [late = std::int64_t{0}](Measurement& m) mutable { m.time_us += late += 800; };
  EXPECT_LE(rig.ticks_until([&] { return rig.state.reason == Hazard::LoopOverrun; }, 10), 3);
  EXPECT_EQ(rig.state.mode, Mode::Retract);
}

TEST(SafetyLoop, ASupervisorThatDiesLeavesTheNeedleWithoutDriveInFiveMilliseconds) {
  verifies("R-44");
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.on_permit = [](Permit&) { return false; };
  EXPECT_EQ(rig.ticks_until([&] { return !rig.gate_state.enabled; }, 100), 5);
  rig.on_permit = [](Permit&) { return true; };
  rig.run(50);
  EXPECT_EQ(rig.state.mode, Mode::Trip);
  EXPECT_EQ(rig.gate_state.drive_mV, 0);
}

TEST(SafetyLoop, AStageThatRestartsIsTakenUpAgainOnceTheDriveIsOff) {
  Rig rig;
  ASSERT_TRUE(rig.go_trip());
  rig.on_measurement = [old = rig.measurement](Measurement& m) { m = old; };
  rig.run(10);
  rig.on_measurement = [](Measurement& m) { m.seq -= 900; };
  rig.run(600);
  EXPECT_EQ(rig.evidence.hazards(), 0U) << name_of(rig.output.worst);
  EXPECT_EQ(rig.state.mode, Mode::Trip);
}

}  // namespace
}  // namespace biopsy::safety
