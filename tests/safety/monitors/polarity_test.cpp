// Rate and balance of the square wave.
#include <gtest/gtest.h>

#include "tests/safety/monitor_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

TEST(VoltageMonitor, WaveOnTheBenchIsForgottenOutsideActiveAndBelowAKilovoltItsBalanceOutsideActiveAndHold) {
  verifies("R-22", "R-23");
  const auto after = [](Mode mode, std::int32_t command_mV, std::int32_t half_period_ticks = 250) {
    VoltageBench bench(mode);
    bench.plan.bench_half_period_ticks = half_period_ticks;
    bench.monitor.flips = 4, bench.monitor.polarity = 1, bench.monitor.wrong_frequency = true;
    bench.monitor.signed_mVms = bench.monitor.total_mVms = 7'000'000, bench.monitor.wave_ticks = 9;
    bench.sample(command_mV, command_mV);
    return bench.monitor;
  };
  for (const Mode mode : {Mode::Safe, Mode::Armed, Mode::Retract, Mode::Hold}) {
    const VoltageMonitor monitor = after(mode, 2'000'000);
    EXPECT_EQ(monitor.flips, 0);
    EXPECT_EQ(monitor.polarity, 0);
    EXPECT_FALSE(monitor.wrong_frequency);
    const bool kept = mode == Mode::Hold;
    EXPECT_EQ(monitor.signed_mVms, kept ? 7'000'000 : 0);
    EXPECT_EQ(monitor.total_mVms, kept ? 7'000'000 : 0);
    EXPECT_EQ(monitor.wave_ticks, kept ? 9 : 0);
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

TEST(VoltageMonitor, WaveMayTakeTwentyPercentLongerOrShorterForTwoPeriods) {
  verifies("R-23");
  for (const std::int64_t ticks : {799, 800, 1'000, 1'200, 1'201}) {
    VoltageBench bench;
    bench.monitor.flips = 4, bench.monitor.polarity = 1, bench.monitor.tick = 5'000;
    bench.monitor.flip_tick = {4'900, 4'800, 4'700, 5'001 - ticks};
    bench.sample(-2'000'000, -2'000'000);
    EXPECT_EQ(bench.names(Hazard::WrongFrequency), ticks < 800 || ticks > 1'200) << ticks;
    EXPECT_EQ(bench.monitor.flip_tick, (std::array<std::int64_t, 4>{5'001, 4'900, 4'800, 4'700}));
    EXPECT_EQ(bench.monitor.flips, 4);
  }
}

TEST(VoltageMonitor, WaveIsJudgedFromTheFifthFlipOn) {
  verifies("R-23");
  VoltageBench bench;
  for (int flip = 0; flip < 9; ++flip) {
    const std::int32_t mV = flip % 2 == 0 ? 2'000'000 : -2'000'000;
    bench.sample(mV, mV);
    EXPECT_EQ(bench.monitor.flips, std::min(flip, 4));
    EXPECT_EQ(bench.names(Hazard::WrongFrequency), flip >= 5) << flip;
  }
}

TEST(VoltageMonitor, WaveOfAPatientsPlanIsJudgedInAHoldToo) {
  verifies("R-22", "R-23");
  for (const std::int32_t half_period_ticks : {-1, 0, 1, 250}) {
    VoltageBench bench(Mode::Hold);
    bench.plan.bench_half_period_ticks = half_period_ticks;
    bench.monitor.polarity = 1, bench.monitor.flips = 4, bench.monitor.wrong_frequency = true;
    bench.ceiling_mV(2'000'000);
    EXPECT_EQ(bench.monitor.flips, half_period_ticks <= 0 ? 4 : 0);
    EXPECT_EQ(bench.names(Hazard::WrongFrequency), half_period_ticks <= 0);
  }
}

TEST(VoltageMonitor, BalanceSumsWhatTheMonitorShowsAndForgetsOverFourOfItsPeriods) {
  verifies("R-22");
  for (const auto& [half_period, forgetting] : {std::pair{0, 2'048}, {100, 2'048}, {1'000, 8'192}}) {
    VoltageBench bench;
    bench.plan.bench_half_period_ticks = half_period;
    bench.monitor.signed_mVms = -std::int64_t{forgetting} * 1'000;
    bench.monitor.total_mVms = std::int64_t{forgetting} * 3'000;
    bench.sample(-2'000'000, -1'999'000);
    EXPECT_EQ(bench.monitor.signed_mVms, -std::int64_t{forgetting} * 1'000 + 1'000 - 1'999'000);
    EXPECT_EQ(bench.monitor.total_mVms, std::int64_t{forgetting} * 3'000 - 3'000 + 1'999'000);
    EXPECT_EQ(bench.monitor.wave_ticks, 1);
    bench.monitor.wave_ticks = forgetting / 2 - 2;
    bench.monitor.signed_mVms = bench.monitor.total_mVms;
    bench.sample(-2'000'000, 2'000'000);
    EXPECT_FALSE(bench.names(Hazard::PolarityStuck)) << "not enough seen";
    bench.sample(-2'000'000, 2'000'000);
    EXPECT_TRUE(bench.names(Hazard::PolarityStuck));
    bench.sample(-2'000'000, 2'000'000);
    EXPECT_TRUE(bench.names(Hazard::PolarityStuck));
    EXPECT_EQ(bench.monitor.wave_ticks, forgetting / 2);
  }
}

TEST(VoltageMonitor, BalanceIsLostWhenOneSignHasMoreThanThreeQuartersOfTheSum) {
  verifies("R-22");
  for (const std::int64_t total : {1'000'488, 1'000'487}) {  // after forgetting: 1'000'000, 999'999
    for (const std::int32_t sign : {1, -1}) {
      VoltageBench bench;
      bench.monitor.wave_ticks = 1'024;
      bench.monitor.total_mVms = total;
      bench.monitor.command_mV = sign * 1'000'000;
      bench.sample(sign * 1'000'000, sign * 1'000'000);
      EXPECT_EQ(bench.monitor.found, total == 1'000'487 ? bit(Hazard::PolarityStuck) : 0);
    }
  }
}

TEST(VoltageMonitor, SlowWaveIsNamedAsSoonAsItIsLateWhicheverFlipItIsCountedFrom) {
  verifies("R-23", "R-22");
  // Late by more than 200 ms since the begin of the wave, or since one of the last four flips.
  for (const std::int32_t flips : {0, 1, 2, 3, 4}) {
    for (std::int32_t counted_from = 0; counted_from <= std::min(flips, 3); ++counted_from) {
      for (const std::int64_t late : {200, 201}) {
        VoltageBench bench;
        bench.monitor.tick = 9'999, bench.monitor.polarity = 1, bench.monitor.flips = flips;
        for (std::int32_t i = 0; i < 4; ++i)
          bench.monitor.flip_tick[static_cast<std::size_t>(i)] =
              i <= flips ? 10'000 - 250 * (i + 1) - (i == counted_from ? late : 0) : 0;
        bench.ceiling_mV(2'000'000);
        EXPECT_EQ(bench.names(Hazard::WrongFrequency), late > 200)
            << flips << " flips, from " << counted_from;
      }
    }
  }
}

TEST(VoltageMonitor, SlowWaveOfAMemoryThatCountsFewerThanNoFlipsIsCountedFromItsBegin) {
  verifies("R-47");
  for (const std::int32_t flips : {-1, -100}) {
    VoltageBench bench;
    bench.monitor.tick = 9'999, bench.monitor.polarity = 1, bench.monitor.flips = flips;
    bench.monitor.flip_tick[0] = 9'000;
    bench.ceiling_mV(2'000'000);
    EXPECT_TRUE(bench.names(Hazard::WrongFrequency));
  }
}

TEST(VoltageMonitor, SlowWaveBeginsWhereTheDriveReachesAKilovolt) {
  verifies("R-23");
  VoltageBench bench;
  bench.monitor.tick = 500;
  bench.ceiling_mV(900'000);
  bench.ceiling_mV(1'000'000);
  EXPECT_EQ(bench.monitor.flip_tick[0], 502);
  int ticks = 1;
  while (!bench.names(Hazard::WrongFrequency) && ticks < 1'000) bench.ceiling_mV(1'000'000), ++ticks;
  EXPECT_EQ(ticks, 452) << "a half-period, 200 ms, and more than that";
}

TEST(VoltageMonitor, SlowWaveIsABenchsOwnAffair) {
  verifies("R-23");
  for (const std::int32_t half_period_ticks : {1, 250}) {
    VoltageBench bench;
    bench.plan.bench_half_period_ticks = half_period_ticks;
    for (int i = 0; i < 600; ++i) bench.ceiling_mV(2'000'000);
    EXPECT_FALSE(bench.names(Hazard::WrongFrequency));
  }
}

}  // namespace
}  // namespace biopsy::safety
