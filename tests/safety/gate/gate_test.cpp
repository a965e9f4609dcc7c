// The gate: one by one, and over random permits and requests.
#include "safety/gate.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <random>
#include <type_traits>

#include "safety/challenge.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

static_assert(!std::is_default_constructible_v<GatedVoltage>);
static_assert(!std::is_constructible_v<GatedVoltage, std::int32_t, bool>);

// A gate with its clock and a supervisor that numbers permits.
struct Bench {
  GateState state;
  std::int64_t now_us = 50'000;
  Permit permit;
  DriveRequest request;
  std::int32_t writers = 1;

  Bench() {
    permit.session = 9;
    permit.epoch = 1;
    permit.ttl_us = limits::kPermitTtl_us;
  }
  void disarm() { permit.hv_enable = false, permit.mode = Mode::Safe, permit.stop = StopCategory::C0Off; }
  void allow(std::int32_t v_max_mV, std::int32_t slew_mV = 400'000) {
    permit.hv_enable = true, permit.mode = Mode::Active, permit.stop = StopCategory::None;
    permit.v_max_mV = v_max_mV, permit.slew_up_mV_per_tick = slew_mV;
  }
  GateResult call(const DriveRequest* wanted, const Permit* granted, std::int64_t dt_us = 1'000) {
    now_us += dt_us;
    const GateResult result = gate(state, wanted, granted, now_us, writers);
    state = result.state;
    return result;
  }
  GateResult tick(std::int32_t wanted_mV) {
    ++permit.seq, ++request.seq;
    request.wanted_mV = wanted_mV;
    return call(&request, &permit);
  }
  GateResult bind() { return disarm(), tick(0); }
  GateResult raise_to(std::int32_t mV) {
    bind();
    allow(limits::kDriveMax_mV);
    GateResult result = tick(mV);
    for (int i = 0; i < 30; ++i) result = tick(mV);
    return result;
  }
};

TEST(Gate, TheBrakeIsOnUnderALivePermitThatSaysSoAndNowhereElse) {
  verifies("R-54");
  Bench bench;
  bench.raise_to(2'000'000);
  bench.request.brake = true;
  EXPECT_FALSE(bench.tick(0).voltage.brake_on()) << "not permitted";
  bench.permit.brake = true;
  EXPECT_TRUE(bench.tick(0).voltage.brake_on());
  EXPECT_TRUE(bench.call(nullptr, &bench.permit).voltage.brake_on()) << "a lost request does not let go";
  bench.request.brake = false;
  EXPECT_FALSE(bench.tick(0).voltage.brake_on());
  bench.request.brake = true;
  EXPECT_TRUE(bench.tick(0).voltage.brake_on());
  bench.permit.brake = false;
  EXPECT_FALSE(bench.tick(0).voltage.brake_on()) << "the permission ends";
  bench.permit.brake = true;
  bench.tick(0);
  EXPECT_FALSE(bench.call(nullptr, nullptr, 5'000).voltage.brake_on()) << "the permit expired";
  EXPECT_FALSE(bench.tick(0).voltage.brake_on()) << "and what is latched off stays off";
  bench.raise_to(2'000'000);
  bench.request.brake = true;
  EXPECT_TRUE(bench.tick(0).voltage.brake_on());
  bench.disarm();
  EXPECT_FALSE(bench.tick(0).voltage.brake_on()) << "HV off lets go, whatever the permit says of the brake";
}

TEST(Gate, GivesNothingForNothing) {
  verifies("R-34", "R-47");
  const GateResult result = gate(GateState{}, nullptr, nullptr, 0, 0);
  EXPECT_EQ(result.voltage.mV(), 0);
  EXPECT_FALSE(result.voltage.hv_enabled());
  EXPECT_NE(result.verdict, GateVerdict::Granted);
  Bench bench;
  EXPECT_EQ(bench.call(nullptr, nullptr).verdict, GateVerdict::NoPermit);
}

TEST(Gate, BindsToASessionOnlyByAPermitThatSaysOff) {
  verifies("R-34");
  Bench bench;
  bench.allow(8'000'000);
  EXPECT_EQ(bench.tick(100'000).verdict, GateVerdict::WrongSession);
  EXPECT_EQ(bench.state.drive_mV, 0);
  EXPECT_EQ(bench.bind().verdict, GateVerdict::Granted);
  bench.allow(8'000'000);
  EXPECT_EQ(bench.tick(100'000).voltage.mV(), 100'000);
}

TEST(Gate, NeverBindsToSessionZero) {
  Bench bench;
  bench.permit.session = 0;
  EXPECT_EQ(bench.bind().verdict, GateVerdict::WrongSession);
}

TEST(Gate, TakesALaterSessionOnlyWhenOffAndTheOldOneIsSilent) {
  Bench bench;
  bench.raise_to(1'000'000);
  Permit other = bench.permit;
  other.session = 10, other.seq = 1;
  other.hv_enable = false;
  EXPECT_EQ(bench.call(nullptr, &other).verdict, GateVerdict::WrongSession)
      << "voltage present, old permit alive";
  bench.bind();
  EXPECT_EQ(bench.call(nullptr, &other).verdict, GateVerdict::WrongSession) << "old permit alive";
  for (int i = 0; i < 5; ++i) bench.call(nullptr, nullptr);
  Permit older = other;
  older.session = 8;
  EXPECT_EQ(bench.call(nullptr, &older).verdict, GateVerdict::WrongSession) << "an old session replayed";
  EXPECT_EQ(bench.call(nullptr, &other).verdict, GateVerdict::Granted);
  EXPECT_EQ(bench.state.permit.session, 10U);
  EXPECT_EQ(bench.tick(0).verdict, GateVerdict::WrongSession) << "the session before";
}

TEST(Gate, RefusesOldEpochsAndOldNumbersWithoutLettingTheVoltageRise) {
  verifies("R-34", "R-26");
  Bench bench;
  bench.raise_to(1'000'000);
  Permit old = bench.permit;
  old.epoch = 0, old.seq += 5;
  ++bench.request.seq, bench.request.wanted_mV = 2'000'000;
  GateResult result = bench.call(&bench.request, &old);
  EXPECT_EQ(result.verdict, GateVerdict::OldEpoch);
  EXPECT_EQ(result.voltage.mV(), 1'000'000);
  old = bench.permit, old.seq -= 1;
  ++bench.request.seq;
  result = bench.call(&bench.request, &old);
  EXPECT_EQ(result.verdict, GateVerdict::OldSequence);
  EXPECT_EQ(result.voltage.mV(), 1'000'000);
}

TEST(Gate, APermitOfANewEpochEndsTheOldOnes) {
  Bench bench;
  bench.raise_to(1'000'000);
  const std::uint32_t old_epoch = bench.permit.epoch;
  ++bench.permit.epoch;
  bench.bind();
  bench.permit.epoch = old_epoch;
  bench.allow(8'000'000);
  EXPECT_EQ(bench.tick(1'000'000).verdict, GateVerdict::OldEpoch);
  EXPECT_EQ(bench.state.drive_mV, 0);
}

TEST(Gate, IsOffFiveMillisecondsAfterTheSupervisorFellSilentAndStaysOff) {
  verifies("R-44");
  Bench bench;
  bench.raise_to(5'000'000);
  const auto silent_tick = [&] { return ++bench.request.seq, bench.call(&bench.request, nullptr); };
  for (int i = 1; i < 5; ++i) EXPECT_EQ(silent_tick().voltage.mV(), 5'000'000) << i;
  const GateResult result = silent_tick();
  EXPECT_EQ(result.voltage.mV(), 0);
  EXPECT_FALSE(result.voltage.hv_enabled());
  EXPECT_EQ(result.verdict, GateVerdict::Expired);
  EXPECT_EQ(bench.tick(5'000'000).verdict, GateVerdict::Expired)
      << "the supervisor is back but has not disarmed";
  EXPECT_EQ(bench.state.drive_mV, 0);
  bench.bind();
  bench.allow(8'000'000);
  EXPECT_EQ(bench.tick(100'000).verdict, GateVerdict::Granted);
}

TEST(Gate, APermitMayShortenItsLifeButNotLengthenIt) {
  Bench bench;
  bench.raise_to(1'000'000);
  bench.permit.ttl_us = 60'000'000;
  bench.tick(1'000'000);
  for (int i = 0; i < 4; ++i) bench.call(nullptr, nullptr);
  EXPECT_EQ(bench.call(nullptr, nullptr).verdict, GateVerdict::Expired);
  bench.permit.ttl_us = 2'000;
  bench.raise_to(1'000'000);
  bench.call(nullptr, nullptr);
  EXPECT_EQ(bench.call(nullptr, nullptr).verdict, GateVerdict::Expired);
}

TEST(Gate, SwitchesOffAtOnceOnAClockThatJumpsOrStandsStill) {
  verifies("R-05");
  for (const std::int64_t dt_us : {std::int64_t{0}, std::int64_t{-1'000}, std::int64_t{5'001}}) {
    Bench bench;
    bench.raise_to(3'000'000);
    ++bench.permit.seq, ++bench.request.seq;
    const GateResult result = bench.call(&bench.request, &bench.permit, dt_us);
    EXPECT_EQ(result.verdict, GateVerdict::ClockJump);
    EXPECT_FALSE(result.voltage.hv_enabled());
    EXPECT_EQ(bench.tick(3'000'000).voltage.mV(), 0) << "latched";
  }
}

TEST(Gate, SwitchesOffAtOnceUnlessThereIsExactlyOneWriter) {
  verifies("R-11");
  for (const std::int32_t writers : {0, 2}) {
    Bench bench;
    bench.raise_to(3'000'000);
    bench.writers = writers;
    const GateResult result = bench.tick(3'000'000);
    EXPECT_EQ(result.verdict, GateVerdict::SecondWriter);
    EXPECT_EQ(result.voltage.mV(), 0);
    bench.writers = 1;
    EXPECT_EQ(bench.tick(3'000'000).voltage.mV(), 0) << "latched";
  }
}

TEST(Gate, TheSamePermitAgainDoesNotLiveLonger) {
  Bench bench;
  bench.raise_to(5'000'000);
  for (int i = 1; i < 5; ++i) EXPECT_EQ(bench.call(nullptr, &bench.permit).voltage.mV(), 5'000'000);
  EXPECT_EQ(bench.call(nullptr, &bench.permit).verdict, GateVerdict::Expired);
}

TEST(Gate, C0TakesEffectInTheSameTickWhateverTheRestOfThePermitSays) {
  verifies("R-36");
  Bench bench;
  bench.raise_to(8'000'000);
  bench.permit.stop = StopCategory::C0Off;
  GateResult result = bench.tick(8'000'000);
  EXPECT_EQ(result.voltage.mV(), 0);
  EXPECT_FALSE(result.voltage.hv_enabled());
  EXPECT_EQ(result.verdict, GateVerdict::Limited);
  bench.raise_to(8'000'000);
  bench.permit.hv_enable = false;
  EXPECT_FALSE(bench.tick(8'000'000).voltage.hv_enabled());
}

TEST(Gate, LowersAtOnceWithoutAnyLeave) {
  verifies("R-34");
  Bench bench;
  bench.raise_to(8'000'000);
  ++bench.request.seq, bench.request.wanted_mV = 10;
  EXPECT_EQ(bench.call(&bench.request, nullptr).voltage.mV(), 10);
}

TEST(Gate, ClampsDownToAnEnvelopeBelowThePresentVoltage) {
  Bench bench;
  bench.raise_to(-6'000'000);
  bench.permit.v_max_mV = 2'000'000;
  EXPECT_EQ(bench.tick(-6'000'000).voltage.mV(), -2'000'000);
  bench.permit.v_max_mV = -1;
  EXPECT_EQ(bench.tick(-6'000'000).voltage.mV(), 0);
}

TEST(Gate, OnlyActiveWithoutAStopMayRiseButPolarityMayChange) {
  verifies("R-34");
  for (const Mode mode : {Mode::Armed, Mode::Hold, Mode::Retract, Mode::Safe}) {
    Bench bench;
    bench.raise_to(2'000'000);
    bench.permit.mode = mode;
    EXPECT_EQ(bench.tick(-3'000'000).voltage.mV(), -2'000'000);
  }
  Bench bench;
  bench.raise_to(2'000'000);
  bench.permit.stop = StopCategory::C2Hold;
  EXPECT_EQ(bench.tick(-3'000'000).voltage.mV(), -2'000'000);
}

TEST(Gate, HardLimitsCannotBePermittedAway) {
  verifies("R-35");
  Bench bench;
  bench.bind();
  bench.allow(std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(bench.tick(std::numeric_limits<std::int32_t>::max()).voltage.mV(),
            limits::kSlewUpMax_mV_per_tick);
  for (int i = 0; i < 100; ++i) bench.tick(std::numeric_limits<std::int32_t>::min());
  EXPECT_EQ(bench.state.drive_mV, -limits::kDriveMax_mV);
}

TEST(Gate, ARepeatedOrMissingRequestNeitherRaisesNorFlipsButFollowsTheEnvelopeDown) {
  Bench bench;
  bench.raise_to(2'000'000);
  ++bench.permit.seq;
  bench.request.wanted_mV = -4'000'000;  // the same number again
  GateResult result = bench.call(&bench.request, &bench.permit);
  EXPECT_EQ(result.verdict, GateVerdict::NoRequest);
  EXPECT_EQ(result.voltage.mV(), 2'000'000);
  --bench.request.seq, ++bench.permit.seq;
  EXPECT_EQ(bench.call(&bench.request, &bench.permit).voltage.mV(), 2'000'000) << "an older request";
  bench.permit.v_max_mV = 500'000, ++bench.permit.seq;
  EXPECT_EQ(bench.call(nullptr, &bench.permit).voltage.mV(), 500'000);
}

TEST(Gate, TakesUpARestartedControllerOnlyWhileOff) {
  Bench bench;
  bench.raise_to(2'000'000);
  bench.request.seq = 0;
  EXPECT_EQ(bench.tick(1'000'000).verdict, GateVerdict::NoRequest);
  bench.bind();
  bench.allow(8'000'000);
  EXPECT_EQ(bench.tick(100'000).verdict, GateVerdict::Granted);
}

TEST(Gate, AnArmedOutputAtZeroDoesNotTakeUpOldRequests) {
  Bench bench;
  bench.bind();
  bench.allow(8'000'000);
  ASSERT_TRUE(bench.tick(0).voltage.hv_enabled());
  bench.request.seq -= 2;
  EXPECT_EQ(bench.tick(100'000).voltage.mV(), 0);
}

TEST(Gate, AnswersTheLastHonouredChallengeWithTheVoltageItReallyPutOut) {
  Bench bench;
  EXPECT_EQ(bench.call(nullptr, nullptr).answered_seq, 0U);
  bench.bind();
  bench.allow(8'000'000);
  bench.permit.challenge = 0xABCD;
  const GateResult result = bench.tick(6'000'000);
  EXPECT_EQ(result.answered_seq, bench.permit.seq);
  EXPECT_EQ(result.answer, answer_to(0xABCD, result.voltage.mV(), Mode::Active, bench.permit.seq));
}

// |V| rises only under a permit that was honoured, is alive and allows it; and never beyond any limit.
TEST(Gate, NeverRisesWithoutLeaveOverARandomWalk) {
  verifies("R-34");
  std::mt19937 random(31);
  const auto one_in = [&](unsigned n) { return random() % n == 0; };
  Bench bench;
  bench.bind();
  int rises = 0, offs = 0;
  for (int i = 0; i < 300'000; ++i) {
    const GateState before = bench.state;
    if (one_in(20)) bench.disarm();
    if (one_in(8))
      bench.allow(static_cast<std::int32_t>(random() % 9'000'000),
                  static_cast<std::int32_t>(random() % 500'000));
    if (one_in(50)) bench.permit.mode = static_cast<Mode>(random() % 9);
    if (one_in(50)) bench.permit.stop = static_cast<StopCategory>(random() % 4);
    ++bench.permit.seq, ++bench.request.seq;
    bench.request.wanted_mV = static_cast<std::int32_t>(random() % 20'000'000) - 10'000'000;
    Permit sent = bench.permit;
    if (one_in(30)) sent.seq -= static_cast<std::uint32_t>(random() % 10);
    if (one_in(30)) sent.epoch -= 1;
    if (one_in(30)) sent.session -= 1;
    bench.writers = one_in(400) ? 2 : 1;
    const Permit* permit = one_in(4) ? nullptr : &sent;
    const DriveRequest* request = one_in(6) ? nullptr : &bench.request;
    const std::int64_t dt_us = one_in(300) ? static_cast<std::int64_t>(random() % 9'000) - 1'000 : 1'000;
    const GateResult result = bench.call(request, permit, dt_us);
    const std::int64_t was = std::abs(std::int64_t{before.drive_mV}),
                       is = std::abs(std::int64_t{result.voltage.mV()});
    const Permit& honoured = result.state.permit;
    ASSERT_LE(is, limits::kDriveMax_mV);
    ASSERT_TRUE(result.voltage.hv_enabled() || is == 0);
    if (is > was) {
      ++rises;
      ASSERT_EQ(bench.writers, 1);
      ASSERT_NE(request, nullptr);
      ASSERT_TRUE(dt_us > 0 && dt_us <= 5'000);
      ASSERT_TRUE(honoured.hv_enable && honoured.mode == Mode::Active && honoured.stop == StopCategory::None);
      ASSERT_EQ(honoured.session, 9U);
      ASSERT_LT(bench.now_us - result.state.permit_us, limits::kPermitTtl_us);
      ASSERT_LE(is, honoured.v_max_mV);
      ASSERT_LE(is - was, std::min(honoured.slew_up_mV_per_tick, limits::kSlewUpMax_mV_per_tick));
    }
    offs += result.state.latched != GateVerdict::Granted && before.latched == GateVerdict::Granted;
    ASSERT_TRUE(result.state.latched == GateVerdict::Granted || is == 0);
  }
  EXPECT_GT(rises, 10'000);
  EXPECT_GT(offs, 300);
}

// In Boot the supervisor alone feeds the interlock, to see that the driver's half opens by itself.
TEST(Gate, FeedsTheInterlockOnceAPermitCameThatIsNotOfBoot) {
  EXPECT_FALSE(GatedVoltage::off().feeds_interlock());
  GateState state;
  EXPECT_FALSE(gate(state, nullptr, nullptr, 1'000, 1).voltage.feeds_interlock());
  for (const Mode mode : {Mode::Boot, Mode::Safe, Mode::Ready, Mode::Trip}) {
    const Permit permit{.session = 1, .epoch = 1, .seq = 1, .ttl_us = 5'000, .mode = mode};
    const GateResult result = gate(GateState{}, nullptr, &permit, 1'000, 1);
    EXPECT_EQ(result.voltage.feeds_interlock(), mode != Mode::Boot) << name_of(mode);
    const GateResult later = gate(result.state, nullptr, nullptr, 2'000, 1);
    EXPECT_EQ(later.voltage.feeds_interlock(), mode != Mode::Boot) << "kept, " << name_of(mode);
  }
}

}  // namespace
}  // namespace biopsy::safety
