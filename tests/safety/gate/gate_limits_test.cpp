// The gate to the millivolt and the microsecond, and from states that only a broken memory holds.
#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "safety/challenge.hpp"
#include "safety/gate.hpp"
#include "safety/interlock.hpp"
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

TEST(Gate, PutsOutTheSmallestVoltagesWithTheirSigns) {
  const Permit permit = active_permit(21);
  for (const std::int32_t wanted_mV : {-2, -1, 0, 1, 2}) {
    const GateResult result = next(driving(0), &permit, wanted_mV);
    EXPECT_EQ(result.voltage.mV(), wanted_mV);
    EXPECT_EQ(result.verdict, GateVerdict::Granted);
  }
}

TEST(Gate, ASlewOfNothingOrLessHoldsTheVoltageWhereItIs) {
  for (const std::int32_t slew_mV : {0, -1, -100}) {
    Permit permit = active_permit(21);
    permit.slew_up_mV_per_tick = slew_mV;
    EXPECT_EQ(next(driving(1'000), &permit, 2'000).voltage.mV(), 1'000) << slew_mV;
    EXPECT_EQ(next(driving(-1'000), &permit, -2'000).voltage.mV(), -1'000) << slew_mV;
  }
}

TEST(Gate, AnEnvelopeOfNothingOrLessGivesZero) {
  for (const std::int32_t v_max_mV : {0, -1, -100}) {
    Permit permit = active_permit(21);
    permit.v_max_mV = v_max_mV;
    EXPECT_EQ(next(driving(1'000), &permit, 2'000).voltage.mV(), 0) << v_max_mV;
  }
}

TEST(Gate, SaysThatItLimitedWhatWasWanted) {
  const Permit permit = active_permit(21);
  EXPECT_EQ(next(driving(1'000), &permit, 11'000).verdict, GateVerdict::Granted);
  EXPECT_EQ(next(driving(1'000), &permit, 11'001).verdict, GateVerdict::Limited);
  EXPECT_EQ(next(driving(1'000), &permit, -11'001).verdict, GateVerdict::Limited);
}

TEST(Gate, UnderAPermitThatSaysOffOnlyZeroIsGranted) {
  const Permit permit = off_permit(9, 21);
  EXPECT_EQ(next(driving(0), &permit, 0).verdict, GateVerdict::Granted);
  EXPECT_EQ(next(driving(0), &permit, 1).verdict, GateVerdict::Limited);
  EXPECT_EQ(next(driving(0), &permit, -1).verdict, GateVerdict::Limited);
}

TEST(Gate, TakesFiveMillisecondsForALongTickAndNoMore) {
  verifies("R-05");
  const Permit permit = active_permit(21);
  EXPECT_EQ(gate(driving(0), nullptr, &permit, kNow_us + 5'000, 1).verdict, GateVerdict::NoRequest);
  EXPECT_EQ(gate(driving(0), nullptr, &permit, kNow_us + 5'001, 1).verdict, GateVerdict::ClockJump);
  EXPECT_EQ(gate(driving(0), nullptr, &permit, kNow_us + 1, 1).verdict, GateVerdict::NoRequest);
  EXPECT_EQ(gate(driving(0), nullptr, &permit, kNow_us, 1).verdict, GateVerdict::ClockJump);
}

TEST(Gate, APermitLivesFiveMillisecondsButForTheLastMicrosecond) {
  EXPECT_EQ(gate(driving(500), nullptr, nullptr, kNow_us + 4'999, 1).voltage.mV(), 500);
  EXPECT_EQ(gate(driving(500), nullptr, nullptr, kNow_us + 5'000, 1).verdict, GateVerdict::Expired);
}

TEST(Gate, AfterAStopOfItsOwnNoOldPermitLivesWhereverTheClockWent) {
  verifies("R-05");
  GateState state = gate(driving(500), nullptr, nullptr, kNow_us - 1'000, 1).state;
  ASSERT_EQ(state.latched, GateVerdict::ClockJump);
  const Permit taking_over = off_permit(10, 1);
  EXPECT_EQ(gate(state, nullptr, &taking_over, kNow_us, 1).verdict, GateVerdict::Granted)
      << "the instant at which the old permit had been honoured has come again";
}

TEST(Gate, ALaterSupervisorIsTakenUpRightAfterAStopOfTheGatesOwn) {
  verifies("R-11");
  const GateState state = gate(driving(500), nullptr, nullptr, kNow_us + 1'000, 2).state;
  const Permit taking_over = off_permit(10, 1);
  const GateResult result = gate(state, nullptr, &taking_over, kNow_us + 2'000, 1);
  EXPECT_EQ(result.state.permit.session, 10U);
  EXPECT_EQ(result.state.latched, GateVerdict::Granted);
}

TEST(Gate, APermitOfAnotherSessionIsNotTheOneSeenBeforeThoughItHasItsNumber) {
  for (const std::uint32_t session : {8U, 10U}) {
    Permit permit = active_permit(20);
    permit.session = session;
    EXPECT_EQ(next(driving(0), &permit, 100).verdict, GateVerdict::WrongSession);
  }
}

TEST(Gate, APermitWithoutANumberIsNoPermitAndHoldsNobodyBack) {
  const Permit numberless = off_permit(9, 0), first = off_permit(10, 1);
  const GateResult result = gate(GateState{}, nullptr, &numberless, kNow_us, 1);
  EXPECT_EQ(result.verdict, GateVerdict::NoPermit);
  EXPECT_EQ(gate(result.state, nullptr, &first, kNow_us + 1'000, 1).state.permit.session, 10U);
}

TEST(Gate, TheLargestNumberIsANumberLikeAnyOther) {
  const Permit last = active_permit(0xFFFF'FFFF);
  EXPECT_EQ(next(driving(0), &last, 100).voltage.mV(), 100);
}

TEST(Gate, GateAnswersTheFirstPermitAndTheLastButNotNone) {
  verifies("R-10");
  EXPECT_EQ(gate(GateState{}, nullptr, nullptr, kNow_us, 1).answer, 0U);
  for (const std::uint32_t seq : {1U, 0xFFFF'FFFFU}) {
    const Permit permit = off_permit(9, seq);
    const GateResult result = gate(GateState{}, nullptr, &permit, kNow_us, 1);
    EXPECT_EQ(result.answered_seq, seq);
    EXPECT_EQ(result.answer, answer_to(0, 0, Mode::Boot, seq));
  }
}

TEST(Gate, PermitsNumberedZeroAreNoneAndAreNotAnswered) {
  verifies("R-10");
  Permit permit;
  permit.session = 9, permit.challenge = 77;
  const GateResult result = gate(GateState{}, nullptr, &permit, 1'000'000, 1);
  EXPECT_EQ(result.verdict, GateVerdict::NoPermit);
  EXPECT_EQ(result.answer, 0U);
  EXPECT_EQ(result.answered_seq, 0U);
}

TEST(Gate, VoltageWithoutAPermitIsSwitchedOff) {
  GateState state = driving(500);
  state.permit = {};
  const GateResult result = next(state, nullptr, 500);
  EXPECT_EQ(result.voltage.mV(), 0);
  EXPECT_FALSE(result.voltage.hv_enabled());
}

TEST(Gate, VoltageAfterAStopOfTheGatesOwnIsSwitchedOff) {
  GateState state = driving(500);
  state.latched = GateVerdict::SecondWriter;
  const GateResult result = next(state, nullptr, 500);
  EXPECT_EQ(result.voltage.mV(), 0);
  EXPECT_FALSE(result.voltage.hv_enabled());
}

TEST(Gate, AnOutputWithVoltageIsNotOffEvenWhereNothingIsEnabled) {
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

// A gate that drives under a permit that it honoured at 1 ms.
GateState driving_since_1_ms() {
  GateState state;
  state.permit = active_permit(1);
  state.permit.v_max_mV = state.permit.slew_up_mV_per_tick = 1'000;
  state.started = true;
  state.permit_us = state.now_us = 1'000;
  return state;
}

const DriveRequest kRequest{.seq = 1, .wanted_mV = 1'000};

TEST(Gate, APermitHonouredAtATimeThatHasNotComeIsDead) {
  verifies("R-47");
  GateState state = driving_since_1_ms();
  state.permit_us = 2'000;
  EXPECT_TRUE(gate(state, &kRequest, nullptr, 2'000, 1).voltage.hv_enabled()) << "honoured in this very tick";
  state.permit_us = 2'001;
  const GateResult result = gate(state, &kRequest, nullptr, 2'000, 1);
  EXPECT_EQ(result.verdict, GateVerdict::Expired);
  EXPECT_FALSE(result.voltage.hv_enabled());
  EXPECT_EQ(result.voltage.mV(), 0);
}

TEST(Gate, APermitWithoutALifeIsDeadInItsOwnTick) {
  verifies("R-47");
  for (const std::int32_t ttl_us : {0, -1, std::numeric_limits<std::int32_t>::min()}) {
    GateState state = driving_since_1_ms();
    state.permit.ttl_us = ttl_us;
    state.permit_us = 2'000;
    EXPECT_EQ(gate(state, &kRequest, nullptr, 2'000, 1).verdict, GateVerdict::Expired) << ttl_us;
  }
}

TEST(Gate, AClockThatComesFromAnywhereIsAJumpAndNothingWorse) {
  verifies("R-05", "R-47");
  constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
  for (const auto& [from_us, to_us] :
       {std::pair{kFirst, kLast}, {kLast, kFirst}, {kLast, kLast}, {kLast - 1, kFirst}}) {
    GateState state = driving_since_1_ms();
    state.now_us = from_us;
    EXPECT_EQ(gate(state, &kRequest, nullptr, to_us, 1).verdict, GateVerdict::ClockJump)
        << from_us << " " << to_us;
  }
  GateState late = driving_since_1_ms();
  late.now_us = late.permit_us = kLast - 1;
  EXPECT_TRUE(gate(late, &kRequest, nullptr, kLast, 1).voltage.hv_enabled())
      << "the last step of a clock is one";
}

TEST(GatedVoltage, MadeWithoutTheGateIsOff) {
  EXPECT_EQ(GatedVoltage::off().mV(), 0);
  EXPECT_FALSE(GatedVoltage::off().hv_enabled());
}

TEST(Interlock, ClosesAtTheInstantOfTheSecondFeeding) {
  const Interlock one = feed_from_supervisor(Interlock{}, 500);
  EXPECT_FALSE(is_closed(one, 500));
  EXPECT_TRUE(is_closed(feed_from_driver(one, 500), 500));
  EXPECT_FALSE(is_closed(feed_from_driver(one, 501), 500)) << "fed in the future: the clock is wrong";
}

TEST(Interlock, OpensTwentyMillisecondsAfterEitherSideStops) {
  verifies("R-43");
  const Interlock fed = feed_from_driver(feed_from_supervisor(Interlock{}, 1'000'000), 1'005'000);
  EXPECT_FALSE(is_closed(Interlock{}, 1'000));
  EXPECT_TRUE(is_closed(fed, 1'019'999));
  EXPECT_FALSE(is_closed(fed, 1'020'000)) << "supervisor stopped";
  const Interlock supervised = feed_from_supervisor(fed, 1'020'000);
  EXPECT_TRUE(is_closed(supervised, 1'024'999));
  EXPECT_FALSE(is_closed(supervised, 1'025'000)) << "driver stopped";
  EXPECT_FALSE(is_closed(supervised, 999'999)) << "clock went back";
  EXPECT_FALSE(is_closed(feed_from_driver(Interlock{}, 1'000), 1'001)) << "supervisor never fed it";
}

// Number 0 means that there is no permit, whatever else stands in it.
TEST(Gate, AnswersNoPermitThatHasNoNumberAndFeedsNoInterlockUnderIt) {
  verifies("R-10");
  Permit numberless = off_permit(9, 0);
  numberless.challenge = 77, numberless.mode = Mode::Safe;
  for (const Permit* permit : {static_cast<const Permit*>(nullptr), &std::as_const(numberless)}) {
    const GateResult result = next(GateState{}, permit, 0);
    EXPECT_EQ(result.answer, 0U);
    EXPECT_EQ(result.answered_seq, 0U);
    EXPECT_EQ(result.verdict, GateVerdict::NoPermit);
    EXPECT_FALSE(result.voltage.feeds_interlock());
  }
  Permit first = numberless;
  first.seq = 1;
  EXPECT_NE(next(GateState{}, &first, 0).answer, 0U);
}

TEST(Gate, OffIsWithoutVoltageEnableBrakeAndInterlock) {
  const GatedVoltage off = GatedVoltage::off();
  EXPECT_EQ(off.mV(), 0);
  EXPECT_FALSE(off.hv_enabled() || off.brake_on() || off.feeds_interlock());
}

}  // namespace
}  // namespace biopsy::safety
