// How far the drive may lead the mean of its square.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/safety/monitor_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

TEST(VoltageMonitor, CeilingLeadsTheMeanOfTheSquareByOnePointTwoSquareKilovolts) {
  verifies("R-52");
  for (const std::int32_t sign : {1, -1}) {
    VoltageBench bench;
    EXPECT_EQ(bench.ceiling_mV(0), 1'095'000);                 // root of 1.2e6
    EXPECT_EQ(bench.ceiling_mV(sign * 2'000'000), 1'109'000);  // root of 1.2e6 + 4e6 / 128
    for (int i = 0; i < 2'000; ++i) bench.ceiling_mV(sign * 2'000'999);
    EXPECT_EQ(bench.ceiling_mV(sign * 2'000'999), 2'280'000);  // root of 1.2e6 + 4e6, less its rounding
  }
}

TEST(VoltageMonitor, CeilingIsTheRootRoundedDownAndNeverAboveWhatTheRobotMay) {
  verifies("R-35", "R-52");
  for (std::int64_t pull = 0; pull <= 70'000'000; pull += 17'351) {
    VoltageBench bench;
    bench.monitor.pull_V2 = pull;
    const std::int64_t before = std::min<std::int64_t>(pull, 64'000'000);
    const std::int64_t mean = before - before / 128;
    const auto root_V = static_cast<std::int32_t>(std::sqrt(static_cast<double>(mean + 1'200'000)));
    EXPECT_EQ(bench.ceiling_mV(0), std::min(root_V, 8'000) * 1'000) << pull;
    EXPECT_EQ(bench.monitor.pull_V2, mean);
  }
  VoltageBench bench;
  for (int i = 0; i < 3'000; ++i) bench.ceiling_mV(20'000'000);
  EXPECT_EQ(bench.ceiling_mV(20'000'000), 8'000'000);
  EXPECT_LE(bench.monitor.pull_V2, 64'000'000);
}

TEST(VoltageMonitor, CeilingOfAMemoryBelowZeroIsThatFromRest) {
  verifies("R-47", "R-52");
  VoltageBench bench;
  bench.monitor.pull_V2 = -5'000'000;
  EXPECT_EQ(bench.ceiling_mV(0), 1'095'000);
  EXPECT_EQ(bench.monitor.pull_V2, 0);
}

TEST(VoltageMonitor, CeilingHasItsSquareReachedAndNotPassed) {
  verifies("R-52");
  for (const auto& [pull, ceiling_mV] : {std::pair{10'078, 1'100'000}, {10'077, 1'099'000}}) {
    VoltageBench bench;
    bench.monitor.pull_V2 = pull;
    EXPECT_EQ(bench.ceiling_mV(0), ceiling_mV) << "1100 squared is 1.2e6 + 10'000";
  }
}

TEST(VoltageMonitor, CeilingBeginsAnewWhereTheDriveWasOff) {
  verifies("R-52");
  for (const Mode mode : {Mode::Ready, Mode::Trip, Mode::Armed, Mode::Hold, Mode::Retract}) {
    VoltageBench bench(mode);
    bench.monitor.pull_V2 = 9'000'000;
    bench.ceiling_mV(0);
    EXPECT_EQ(bench.monitor.pull_V2, hv_permitted(mode) ? 9'000'000 - 9'000'000 / 128 : 0) << name_of(mode);
  }
}

TEST(VoltageMonitor, CeilingIsTheRobotsOwnForABenchWithoutANeedleAndKeptWhereNothingNewWasMeasured) {
  verifies("R-52");
  VoltageBench bench;
  for (const std::int32_t half_period_ticks : {1, 250}) {
    bench.plan.bench_half_period_ticks = half_period_ticks;
    EXPECT_EQ(bench.ceiling_mV(0), 8'000'000);
  }
  EXPECT_EQ(update(bench.plan, bench.monitor, bench.seen, false, false).ceiling_mV, 8'000'000);
  EXPECT_EQ(Evidence{}.ceiling_mV, 0) << "nothing is allowed by default";
  VoltageBench implausible;
  implausible.plan.bench_half_period_ticks = -1;
  EXPECT_EQ(implausible.ceiling_mV(0), 1'095'000);
}

TEST(VoltageMonitor, CeilingHoldsAControllerThatAsksForEverythingNearToWhatItHad) {
  verifies("R-52", "R-31");
  Rig rig;
  rig.plan.steps[0].slew_up_mV_per_tick = 400'000;
  rig.wanted_mV = 2'500'000;
  ASSERT_TRUE(rig.go_active());
  rig.wanted_mV = 8'000'000;
  for (int tick = 1; tick <= 100; ++tick) {
    rig.tick();
    // V^2 leads its mean by 1.2, and the mean gains at most that share of the lead in each tick.
    const double most_kV2 = 2.5 * 2.5 + 1.2 * (1.0 + tick / 128.0);
    const double drive_kV = std::abs(rig.gate_state.drive_mV) * 1e-6;
    ASSERT_LE(drive_kV * drive_kV, most_kV2 + 0.01) << tick;
  }
  EXPECT_GT(std::abs(rig.gate_state.drive_mV), 2'800'000) << "it is not refused either";
}

}  // namespace
}  // namespace biopsy::safety
