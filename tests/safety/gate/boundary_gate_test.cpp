// The gate to the millivolt and the microsecond, and from states that only a broken memory holds.
#include <gtest/gtest.h>

#include "safety/challenge.hpp"
#include "safety/gate.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

constexpr std::int64_t kNow_us = 1'000'000;

Permit off_permit(std::uint32_t session, std::uint32_t seq) {
  Permit permit;
  permit.session = session, permit.epoch = 1, permit.seq = seq;
  permit.ttl_us = limits::kPermitTtl_us;
  return permit;
}

Permit active_permit(std::uint32_t seq) {
  Permit permit = off_permit(9, seq);
  permit.mode = Mode::Active, permit.stop = StopCategory::None, permit.hv_enable = true;
  permit.v_max_mV = 5'000'000, permit.slew_up_mV_per_tick = 10'000;
  return permit;
}

// A gate under way: permit 20 honoured now, requests up to 40 seen.
GateState driving(std::int32_t drive_mV) {
  GateState state;
  state.permit = active_permit(20);
  state.permit_us = state.now_us = kNow_us;
  state.request_seq = 40;
  state.drive_mV = drive_mV;
  state.enabled = state.started = true;
  return state;
}

GateResult next(const GateState& state, const Permit* permit, std::int32_t wanted_mV) {
  const DriveRequest request{.seq = state.request_seq + 1, .wanted_mV = wanted_mV};
  return gate(state, &request, permit, state.now_us + 1'000, 1);
}

TEST(GateToTheMillivolt, PutsOutTheSmallestVoltagesWithTheirSigns) {
  const Permit permit = active_permit(21);
  for (const std::int32_t wanted_mV : {-2, -1, 0, 1, 2}) {
    const GateResult result = next(driving(0), &permit, wanted_mV);
    EXPECT_EQ(result.voltage.mV(), wanted_mV);
    EXPECT_EQ(result.verdict, GateVerdict::Granted);
  }
}

TEST(GateToTheMillivolt, ASlewOfNothingOrLessHoldsTheVoltageWhereItIs) {
  for (const std::int32_t slew_mV : {0, -1, -100}) {
    Permit permit = active_permit(21);
    permit.slew_up_mV_per_tick = slew_mV;
    EXPECT_EQ(next(driving(1'000), &permit, 2'000).voltage.mV(), 1'000) << slew_mV;
    EXPECT_EQ(next(driving(-1'000), &permit, -2'000).voltage.mV(), -1'000) << slew_mV;
  }
}

TEST(GateToTheMillivolt, AnEnvelopeOfNothingOrLessGivesZero) {
  for (const std::int32_t v_max_mV : {0, -1, -100}) {
    Permit permit = active_permit(21);
    permit.v_max_mV = v_max_mV;
    EXPECT_EQ(next(driving(1'000), &permit, 2'000).voltage.mV(), 0) << v_max_mV;
  }
}

TEST(GateToTheMillivolt, SaysThatItLimitedWhatWasWanted) {
  const Permit permit = active_permit(21);
  EXPECT_EQ(next(driving(1'000), &permit, 11'000).verdict, GateVerdict::Granted);
  EXPECT_EQ(next(driving(1'000), &permit, 11'001).verdict, GateVerdict::Limited);
  EXPECT_EQ(next(driving(1'000), &permit, -11'001).verdict, GateVerdict::Limited);
}

TEST(GateToTheMillivolt, UnderAPermitThatSaysOffOnlyZeroIsGranted) {
  const Permit permit = off_permit(9, 21);
  EXPECT_EQ(next(driving(0), &permit, 0).verdict, GateVerdict::Granted);
  EXPECT_EQ(next(driving(0), &permit, 1).verdict, GateVerdict::Limited);
  EXPECT_EQ(next(driving(0), &permit, -1).verdict, GateVerdict::Limited);
}

TEST(GateToTheMicrosecond, TakesFiveMillisecondsForALongTickAndNoMore) {
  verifies("R-05");
  const Permit permit = active_permit(21);
  EXPECT_EQ(gate(driving(0), nullptr, &permit, kNow_us + 5'000, 1).verdict, GateVerdict::NoRequest);
  EXPECT_EQ(gate(driving(0), nullptr, &permit, kNow_us + 5'001, 1).verdict, GateVerdict::ClockJump);
  EXPECT_EQ(gate(driving(0), nullptr, &permit, kNow_us + 1, 1).verdict, GateVerdict::NoRequest);
  EXPECT_EQ(gate(driving(0), nullptr, &permit, kNow_us, 1).verdict, GateVerdict::ClockJump);
}

TEST(GateToTheMicrosecond, APermitLivesFiveMillisecondsButForTheLastMicrosecond) {
  EXPECT_EQ(gate(driving(500), nullptr, nullptr, kNow_us + 4'999, 1).voltage.mV(), 500);
  EXPECT_EQ(gate(driving(500), nullptr, nullptr, kNow_us + 5'000, 1).verdict, GateVerdict::Expired);
}

TEST(GateToTheMicrosecond, AfterAStopOfItsOwnNoOldPermitLivesWhereverTheClockWent) {
  verifies("R-05");
  GateState state = gate(driving(500), nullptr, nullptr, kNow_us - 1'000, 1).state;
  ASSERT_EQ(state.latched, GateVerdict::ClockJump);
  const Permit taking_over = off_permit(10, 1);
  EXPECT_EQ(gate(state, nullptr, &taking_over, kNow_us, 1).verdict, GateVerdict::Granted)
      << "the instant at which the old permit had been honoured has come again";
}

TEST(GateSessions, ALaterSupervisorIsTakenUpRightAfterAStopOfTheGatesOwn) {
  verifies("R-11");
  const GateState state = gate(driving(500), nullptr, nullptr, kNow_us + 1'000, 2).state;
  const Permit taking_over = off_permit(10, 1);
  const GateResult result = gate(state, nullptr, &taking_over, kNow_us + 2'000, 1);
  EXPECT_EQ(result.state.permit.session, 10U);
  EXPECT_EQ(result.state.latched, GateVerdict::Granted);
}

TEST(GateSessions, APermitOfAnotherSessionIsNotTheOneSeenBeforeThoughItHasItsNumber) {
  for (const std::uint32_t session : {8U, 10U}) {
    Permit permit = active_permit(20);
    permit.session = session;
    EXPECT_EQ(next(driving(0), &permit, 100).verdict, GateVerdict::WrongSession);
  }
}

TEST(GateSessions, APermitWithoutANumberIsNoPermitAndHoldsNobodyBack) {
  const Permit numberless = off_permit(9, 0), first = off_permit(10, 1);
  const GateResult result = gate(GateState{}, nullptr, &numberless, kNow_us, 1);
  EXPECT_EQ(result.verdict, GateVerdict::NoPermit);
  EXPECT_EQ(gate(result.state, nullptr, &first, kNow_us + 1'000, 1).state.permit.session, 10U);
}

TEST(GateSessions, TheLargestNumberIsANumberLikeAnyOther) {
  const Permit last = active_permit(0xFFFF'FFFF);
  EXPECT_EQ(next(driving(0), &last, 100).voltage.mV(), 100);
}

TEST(GateAnswers, TheFirstPermitAndTheLastButNotNone) {
  verifies("R-10");
  EXPECT_EQ(gate(GateState{}, nullptr, nullptr, kNow_us, 1).answer, 0U);
  for (const std::uint32_t seq : {1U, 0xFFFF'FFFFU}) {
    const Permit permit = off_permit(9, seq);
    const GateResult result = gate(GateState{}, nullptr, &permit, kNow_us, 1);
    EXPECT_EQ(result.answered_seq, seq);
    EXPECT_EQ(result.answer, answer_to(0, 0, Mode::Boot, seq));
  }
}

TEST(BrokenGateMemory, VoltageWithoutAPermitIsSwitchedOff) {
  GateState state = driving(500);
  state.permit = {};
  const GateResult result = next(state, nullptr, 500);
  EXPECT_EQ(result.voltage.mV(), 0);
  EXPECT_FALSE(result.voltage.hv_enabled());
}

TEST(BrokenGateMemory, VoltageAfterAStopOfTheGatesOwnIsSwitchedOff) {
  GateState state = driving(500);
  state.latched = GateVerdict::SecondWriter;
  const GateResult result = next(state, nullptr, 500);
  EXPECT_EQ(result.voltage.mV(), 0);
  EXPECT_FALSE(result.voltage.hv_enabled());
}

TEST(BrokenGateMemory, AnOutputWithVoltageIsNotOffEvenWhereNothingIsEnabled) {
  for (const std::int32_t drive_mV : {-500, 500}) {
    GateState state = driving(drive_mV);
    state.enabled = false;
    state.permit.ttl_us = 0;
    const Permit taking_over = off_permit(10, 1);
    EXPECT_EQ(gate(state, nullptr, &taking_over, kNow_us + 1'000, 1).verdict, GateVerdict::WrongSession);
    state.enabled = true, state.drive_mV = 0;
    EXPECT_EQ(gate(state, nullptr, &taking_over, kNow_us + 1'000, 1).verdict, GateVerdict::WrongSession);
  }
}

TEST(GatedVoltage, MadeWithoutTheGateIsOff) {
  EXPECT_EQ(GatedVoltage::off().mV(), 0);
  EXPECT_FALSE(GatedVoltage::off().hv_enabled());
}

}  // namespace
}  // namespace biopsy::safety
