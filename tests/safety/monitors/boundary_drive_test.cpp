// The watch over the high voltage, sample by sample and to the millivolt.
#include <gtest/gtest.h>

#include <cstdlib>

#include "safety/monitors/voltage_monitor.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

struct Bench {
  PlanFacts plan = three_stage_plan();
  VoltageMonitor watch;
  SupervisorInputs seen;

  explicit Bench(Mode mode = Mode::Active, bool enabled = true) {
    seen.permit.mode = mode;
    seen.permit.v_max_mV = 8'000'000;
    seen.permit.hv_enable = seen.measurement.hv_enabled = enabled;
    seen.acquiring = false;
  }
  DriveFindings sample(std::int32_t command_mV, std::int32_t monitor_mV, std::int32_t current_nA = 0) {
    seen.measurement.command_mV = command_mV;
    seen.measurement.monitor_mV = monitor_mV;
    seen.measurement.current_nA = current_nA;
    return update(plan, watch, seen, true, false);
  }
  bool names(Hazard hazard) const { return (watch.found & bit(hazard)) != 0; }
};

// What a fourth of four bad samples in a row would be: only the last one is judged here.
bool disagrees(std::int32_t before_mV, std::int32_t command_mV, std::int32_t monitor_mV,
               bool enabled = true) {
  Bench bench(Mode::Active, enabled);
  bench.watch.command_mV = before_mV;
  bench.watch.disagree_ticks = 2;
  bench.sample(command_mV, monitor_mV);
  return bench.names(Hazard::MonitorDisagrees);
}

TEST(MonitorAndCommand, MayDifferByThreePercentOfTheLargerOfTheLastTwoCommands) {
  verifies("R-08");
  for (const std::int32_t sign : {1, -1}) {
    EXPECT_FALSE(disagrees(sign * 6'000'000, sign * 6'000'000, sign * 6'180'000));
    EXPECT_TRUE(disagrees(sign * 6'000'000, sign * 6'000'000, sign * 6'180'001));
    EXPECT_FALSE(disagrees(sign * 6'000'000, sign * 6'000'000, sign * 5'820'000));
    EXPECT_TRUE(disagrees(sign * 6'000'000, sign * 6'000'000, sign * 5'819'999));
    EXPECT_FALSE(disagrees(sign * 6'000'000, sign * 6'000'000, 0, false)) << "not enabled";
  }
  for (const auto& [before_mV, command_mV] : {std::pair{1'000'000, 6'000'000}, {6'000'000, 1'000'000}}) {
    EXPECT_FALSE(disagrees(before_mV, command_mV, 820'000));
    EXPECT_TRUE(disagrees(before_mV, command_mV, 819'999));
    EXPECT_TRUE(disagrees(before_mV, command_mV, 0));
    EXPECT_FALSE(disagrees(before_mV, command_mV, 6'180'000));
    EXPECT_TRUE(disagrees(before_mV, command_mV, 6'180'001));
  }
}

TEST(MonitorAndCommand, MayAlwaysDifferByAHundredVolts) {
  verifies("R-08");
  EXPECT_FALSE(disagrees(0, 0, 100'000));
  EXPECT_TRUE(disagrees(0, 0, 100'001));
  EXPECT_FALSE(disagrees(0, 0, -100'000));
  EXPECT_TRUE(disagrees(0, 0, -100'001));
}

TEST(MonitorAndCommand, MayDifferForTwoSamples) {
  Bench bench;
  for (const bool named : {false, false, true, true}) {
    bench.sample(0, 200'000);
    EXPECT_EQ(bench.names(Hazard::MonitorDisagrees), named);
  }
}

TEST(OverVoltage, IsAboveEightPointTwoKilovoltsTwice) {
  verifies("R-06");
  for (const std::int32_t sign : {1, -1}) {
    Bench bench;
    for (int i = 0; i < 3; ++i) bench.sample(sign * 8'000'000, sign * 8'200'000);
    EXPECT_FALSE(bench.names(Hazard::OverVoltage));
    bench.sample(sign * 8'000'000, sign * 8'200'001);
    EXPECT_FALSE(bench.names(Hazard::OverVoltage));
    bench.sample(sign * 8'000'000, sign * 8'200'001);
    EXPECT_TRUE(bench.names(Hazard::OverVoltage));
  }
}

// A change of the command explains its charging current for the tick it was put out in and two more.
TEST(Arc, IsAMilliampereAboveWhatTheLastThreeChangesExplainTwice) {
  verifies("R-07");
  const auto is_arc = [](Bench bench, std::int32_t command_mV, std::int32_t current_nA) {
    bench.watch.arc_ticks = 1;
    bench.sample(command_mV, command_mV, current_nA);
    return bench.names(Hazard::Arc);
  };
  Bench bench;
  const auto limit = [&](std::int32_t command_mV, std::int32_t limit_nA) {
    for (const std::int32_t sign : {1, -1}) {
      EXPECT_FALSE(is_arc(bench, command_mV, sign * limit_nA)) << limit_nA;
      EXPECT_TRUE(is_arc(bench, command_mV, sign * (limit_nA + 1))) << limit_nA;
    }
    bench.sample(command_mV, command_mV);
  };
  limit(0, 1'000'000);
  limit(1'000'000, 3'000'000);
  limit(1'000'000, 3'000'000);
  limit(1'000'000, 3'000'000);
  limit(1'000'000, 1'000'000);
  limit(-1'000'000, 5'000'000);
  limit(-700'000, 5'000'000);
  limit(-700'000, 5'000'000);
  limit(-700'000, 1'600'000);
  limit(-700'000, 1'000'000);
  bench.sample(-700'000, -700'000, 2'000'000);
  EXPECT_FALSE(bench.names(Hazard::Arc)) << "one sample";
  bench.sample(-700'000, -700'000, 2'000'000);
  EXPECT_TRUE(bench.names(Hazard::Arc));
}

TEST(Obedience, AllowsTwoHundredVoltsAboveThePermitAndTwoTicksOfTransport) {
  verifies("R-09");
  for (const std::int32_t sign : {1, -1}) {
    Bench bench;
    bench.seen.permit.v_max_mV = 1'000'000;
    for (int i = 0; i < 5; ++i) bench.sample(sign * 1'200'000, sign * 1'200'000);
    EXPECT_FALSE(bench.names(Hazard::DriverDisobeys));
    for (const bool named : {false, false, true, true}) {
      bench.sample(sign * 1'300'000, sign * 1'300'000);
      EXPECT_EQ(bench.names(Hazard::DriverDisobeys), named);
    }
    bench.watch.disobey_ticks = 2;
    bench.sample(sign * 1'200'001, sign * 1'200'001);
    EXPECT_TRUE(bench.names(Hazard::DriverDisobeys));
  }
}

TEST(ZeroVolts, TakeThreeQuietSamplesAndAreLostAtOnceByACommand) {
  verifies("R-01");
  Bench bench(Mode::Ready, false);
  for (const bool zero : {false, false, true, true})
    EXPECT_EQ(bench.sample(100'000, -100'000).zero_volts, zero);
  EXPECT_FALSE(bench.sample(100'001, 0).zero_volts);
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(bench.sample(-100'001, 0).zero_volts);
  for (const bool zero : {false, false, true}) EXPECT_EQ(bench.sample(0, 0).zero_volts, zero);
}

TEST(ZeroVolts, AreLostByTheMonitorAfterThreeSamples) {
  Bench bench(Mode::Ready, false);
  for (int i = 0; i < 3; ++i) bench.sample(0, 0);
  for (const bool zero : {true, true, false, false}) EXPECT_EQ(bench.sample(0, 100'001).zero_volts, zero);
  for (const bool zero : {false, false, true}) EXPECT_EQ(bench.sample(0, 100'000).zero_volts, zero);
}

TEST(ZeroVolts, HaveToBeShownAnewByAStageThatHadFallenSilent) {
  Bench bench(Mode::Ready, false);
  for (int i = 0; i < 3; ++i) bench.sample(0, 0);
  EXPECT_FALSE(update(bench.plan, bench.watch, bench.seen, false, true).zero_volts);
  for (const bool zero : {false, false, true}) EXPECT_EQ(bench.sample(0, 0).zero_volts, zero);
}

TEST(ResidualCharge, IsVoltageAtTheTwoHundredthMeasurementAfterSwitchingOff) {
  verifies("R-01");
  Bench bench(Mode::Trip, false);
  for (int i = 1; i < 200; ++i) bench.sample(0, 150'000);
  EXPECT_FALSE(bench.names(Hazard::ResidualCharge));
  bench.sample(0, 150'000);
  EXPECT_TRUE(bench.names(Hazard::ResidualCharge));
  bench.sample(0, 150'000);
  EXPECT_TRUE(bench.names(Hazard::ResidualCharge));
  bench.sample(0, 0);
  EXPECT_FALSE(bench.names(Hazard::ResidualCharge));
  for (const bool named : {false, false, true}) {
    bench.sample(0, 150'000);
    EXPECT_EQ(bench.names(Hazard::ResidualCharge), named);
  }
}

TEST(Wave, OnTheBenchIsForgottenOutsideActiveAndBelowAKilovoltItsBalanceOutsideActiveAndHold) {
  verifies("R-22", "R-23");
  const auto after = [](Mode mode, std::int32_t command_mV, std::int32_t half_period_ticks = 250) {
    Bench bench(mode);
    bench.plan.bench_half_period_ticks = half_period_ticks;
    bench.watch.flips = 4, bench.watch.polarity = 1, bench.watch.wrong_frequency = true;
    bench.watch.signed_mVms = bench.watch.total_mVms = 7'000'000, bench.watch.wave_ticks = 9;
    bench.sample(command_mV, command_mV);
    return bench.watch;
  };
  for (const Mode mode : {Mode::Safe, Mode::Armed, Mode::Retract, Mode::Hold}) {
    const VoltageMonitor watch = after(mode, 2'000'000);
    EXPECT_EQ(watch.flips, 0);
    EXPECT_EQ(watch.polarity, 0);
    EXPECT_FALSE(watch.wrong_frequency);
    const bool kept = mode == Mode::Hold;
    EXPECT_EQ(watch.signed_mVms, kept ? 7'000'000 : 0);
    EXPECT_EQ(watch.total_mVms, kept ? 7'000'000 : 0);
    EXPECT_EQ(watch.wave_ticks, kept ? 9 : 0);
  }
  const VoltageMonitor low = after(Mode::Active, 999'999), high = after(Mode::Active, 1'000'000);
  EXPECT_EQ(low.flips, 0);
  EXPECT_EQ(low.polarity, 0);
  EXPECT_FALSE(low.wrong_frequency);
  EXPECT_EQ(low.wave_ticks, 9);
  EXPECT_EQ(high.flips, 4);
  EXPECT_EQ(high.polarity, 1);
  EXPECT_EQ(high.wave_ticks, 10);
  EXPECT_EQ(after(Mode::Active, -1'000'000).polarity, -1);
}

TEST(Wave, MayTakeTwentyPercentLongerOrShorterForTwoPeriods) {
  verifies("R-23");
  for (const std::int64_t ticks : {799, 800, 1'000, 1'200, 1'201}) {
    Bench bench;
    bench.watch.flips = 4, bench.watch.polarity = 1, bench.watch.tick = 5'000;
    bench.watch.flip_tick = {4'900, 4'800, 4'700, 5'001 - ticks};
    bench.sample(-2'000'000, -2'000'000);
    EXPECT_EQ(bench.names(Hazard::WrongFrequency), ticks < 800 || ticks > 1'200) << ticks;
    EXPECT_EQ(bench.watch.flip_tick, (std::array<std::int64_t, 4>{5'001, 4'900, 4'800, 4'700}));
    EXPECT_EQ(bench.watch.flips, 4);
  }
}

TEST(Wave, IsJudgedFromTheFifthFlipOn) {
  verifies("R-23");
  Bench bench;
  for (int flip = 0; flip < 9; ++flip) {
    const std::int32_t mV = flip % 2 == 0 ? 2'000'000 : -2'000'000;
    bench.sample(mV, mV);
    EXPECT_EQ(bench.watch.flips, std::min(flip, 4));
    EXPECT_EQ(bench.names(Hazard::WrongFrequency), flip >= 5) << flip;
  }
}

TEST(Balance, SumsWhatTheMonitorShowsAndForgetsOverFourOfItsPeriods) {
  verifies("R-22");
  for (const auto& [half_period, forgetting] : {std::pair{0, 2'048}, {100, 2'048}, {1'000, 8'192}}) {
    Bench bench;
    bench.plan.bench_half_period_ticks = half_period;
    bench.watch.signed_mVms = -std::int64_t{forgetting} * 1'000;
    bench.watch.total_mVms = std::int64_t{forgetting} * 3'000;
    bench.sample(-2'000'000, -1'999'000);
    EXPECT_EQ(bench.watch.signed_mVms, -std::int64_t{forgetting} * 1'000 + 1'000 - 1'999'000);
    EXPECT_EQ(bench.watch.total_mVms, std::int64_t{forgetting} * 3'000 - 3'000 + 1'999'000);
    EXPECT_EQ(bench.watch.wave_ticks, 1);
    bench.watch.wave_ticks = forgetting / 2 - 2;
    bench.watch.signed_mVms = bench.watch.total_mVms;
    bench.sample(-2'000'000, 2'000'000);
    EXPECT_FALSE(bench.names(Hazard::PolarityStuck)) << "not enough seen";
    bench.sample(-2'000'000, 2'000'000);
    EXPECT_TRUE(bench.names(Hazard::PolarityStuck));
    bench.sample(-2'000'000, 2'000'000);
    EXPECT_TRUE(bench.names(Hazard::PolarityStuck));
    EXPECT_EQ(bench.watch.wave_ticks, forgetting / 2);
  }
}

TEST(Balance, IsLostWhenOneSignHasMoreThanThreeQuartersOfTheSum) {
  verifies("R-22");
  for (const std::int64_t total : {1'000'488, 1'000'487}) {  // after forgetting: 1'000'000, 999'999
    for (const std::int32_t sign : {1, -1}) {
      Bench bench;
      bench.watch.wave_ticks = 1'024;
      bench.watch.total_mVms = total;
      bench.watch.command_mV = sign * 1'000'000;
      bench.sample(sign * 1'000'000, sign * 1'000'000);
      EXPECT_EQ(bench.watch.found, total == 1'000'487 ? bit(Hazard::PolarityStuck) : 0);
    }
  }
}

TEST(Drive, IsReportedByItsAmountUpToItsLimit) {
  for (const std::int32_t drive_mV : {-9'000'000, -8'000'001, -2, -1, 0, 1, 2, 7'999'999, 9'000'000}) {
    Bench bench;
    EXPECT_EQ(bench.sample(drive_mV, drive_mV).drive_mV, std::min(std::abs(drive_mV), 8'000'000));
  }
}

TEST(Images, AreDisturbedByAChangeOfMoreThanAHundredVoltsOrByAStageThatSaysNothing) {
  Bench bench;
  bench.sample(1'000'000, 1'000'000);
  EXPECT_FALSE(bench.sample(-1'000'000, -1'000'000).image_disturbed) << "no image is being taken";
  bench.seen.acquiring = true;
  EXPECT_FALSE(bench.sample(-900'000, -900'000).image_disturbed);
  EXPECT_FALSE(bench.sample(-900'001, -900'001).image_disturbed);
  EXPECT_FALSE(bench.sample(-1'000'000, -1'000'000).image_disturbed);
  EXPECT_TRUE(bench.sample(-899'999, -899'999).image_disturbed);
  EXPECT_TRUE(bench.sample(-1'000'000, -1'000'000).image_disturbed);
  EXPECT_TRUE(update(bench.plan, bench.watch, bench.seen, false, false).image_disturbed);
}

TEST(Images, AreSoundWhereNothingSwitched) {
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  EXPECT_FALSE(rig.evidence.image_disturbed);
}

}  // namespace
}  // namespace biopsy::safety
