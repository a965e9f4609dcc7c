// The drive may not run ahead of the needle's answer, and a needle that sinks while the drive stays is not
// believed.
#include <gtest/gtest.h>

#include <cmath>

#include "safety/monitors/depth_monitor.hpp"
#include "safety/monitors/voltage_monitor.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

struct Drive {
  PlanFacts plan = three_stage_plan();
  VoltageMonitor watch;
  SupervisorInputs seen;

  explicit Drive(Mode mode = Mode::Active) {
    seen.permit.mode = mode;
    seen.permit.v_max_mV = 8'000'000;
    seen.permit.hv_enable = seen.measurement.hv_enabled = true;
  }
  std::int32_t ceiling_mV(std::int32_t command_mV) {
    seen.measurement.command_mV = seen.measurement.monitor_mV = command_mV;
    return update(plan, watch, seen, true, false).ceiling_mV;
  }
};

TEST(Ceiling, LeadsTheMeanOfTheSquareByOnePointTwoSquareKilovolts) {
  verifies("R-52");
  for (const std::int32_t sign : {1, -1}) {
    Drive drive;
    EXPECT_EQ(drive.ceiling_mV(0), 1'095'000);                 // root of 1.2e6
    EXPECT_EQ(drive.ceiling_mV(sign * 2'000'000), 1'109'000);  // root of 1.2e6 + 4e6 / 128
    for (int i = 0; i < 2'000; ++i) drive.ceiling_mV(sign * 2'000'999);
    EXPECT_EQ(drive.ceiling_mV(sign * 2'000'999), 2'280'000);  // root of 1.2e6 + 4e6, less its rounding
  }
}

TEST(Ceiling, IsTheRootRoundedDownAndNeverAboveWhatTheRobotMay) {
  verifies("R-35", "R-52");
  for (std::int64_t pull = 0; pull <= 70'000'000; pull += 17'351) {
    Drive drive;
    drive.watch.pull_V2 = pull;
    const std::int64_t before = std::min<std::int64_t>(pull, 64'000'000);
    const std::int64_t mean = before - before / 128;
    const auto root_V = static_cast<std::int32_t>(std::sqrt(static_cast<double>(mean + 1'200'000)));
    EXPECT_EQ(drive.ceiling_mV(0), std::min(root_V, 8'000) * 1'000) << pull;
    EXPECT_EQ(drive.watch.pull_V2, mean);
  }
  Drive drive;
  for (int i = 0; i < 3'000; ++i) drive.ceiling_mV(20'000'000);
  EXPECT_EQ(drive.ceiling_mV(20'000'000), 8'000'000);
  EXPECT_LE(drive.watch.pull_V2, 64'000'000);
}

TEST(Ceiling, OfAMemoryBelowZeroIsThatFromRest) {
  verifies("R-47", "R-52");
  Drive drive;
  drive.watch.pull_V2 = -5'000'000;
  EXPECT_EQ(drive.ceiling_mV(0), 1'095'000);
  EXPECT_EQ(drive.watch.pull_V2, 0);
}

TEST(Ceiling, HasItsSquareReachedAndNotPassed) {
  verifies("R-52");
  for (const auto& [pull, ceiling_mV] : {std::pair{10'078, 1'100'000}, {10'077, 1'099'000}}) {
    Drive drive;
    drive.watch.pull_V2 = pull;
    EXPECT_EQ(drive.ceiling_mV(0), ceiling_mV) << "1100 squared is 1.2e6 + 10'000";
  }
}

TEST(Ceiling, BeginsAnewWhereTheDriveWasOff) {
  verifies("R-52");
  for (const Mode mode : {Mode::Ready, Mode::Trip, Mode::Armed, Mode::Hold, Mode::Retract}) {
    Drive drive(mode);
    drive.watch.pull_V2 = 9'000'000;
    drive.ceiling_mV(0);
    EXPECT_EQ(drive.watch.pull_V2, hv_permitted(mode) ? 9'000'000 - 9'000'000 / 128 : 0) << name_of(mode);
  }
}

TEST(Ceiling, IsTheRobotsOwnForABenchWithoutANeedleAndKeptWhereNothingNewWasMeasured) {
  verifies("R-52");
  Drive drive;
  for (const std::int32_t half_period_ticks : {1, 250}) {
    drive.plan.bench_half_period_ticks = half_period_ticks;
    EXPECT_EQ(drive.ceiling_mV(0), 8'000'000);
  }
  EXPECT_EQ(update(drive.plan, drive.watch, drive.seen, false, false).ceiling_mV, 8'000'000);
  EXPECT_EQ(Evidence{}.ceiling_mV, 0) << "nothing is allowed by default";
  Drive implausible;
  implausible.plan.bench_half_period_ticks = -1;
  EXPECT_EQ(implausible.ceiling_mV(0), 1'095'000);
}

TEST(Ceiling, HoldsAControllerThatAsksForEverythingNearToWhatItHad) {
  verifies("R-52", "R-31");
  Rig rig;
  rig.plan.stages[0].slew_up_mV_per_tick = 400'000;
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

struct Needle {
  PlanFacts plan = three_stage_plan();
  DepthMonitor watch;
  SupervisorInputs seen;

  explicit Needle(Mode mode = Mode::Active) {
    seen.permit.mode = mode;
    seen.permit.depth_max_um = 1'000'000;
    seen.measurement.laser_valid = true;
  }
  bool sinks(std::int32_t depth_um, std::int32_t drive_mV = 4'000'000) {
    seen.measurement.depth_um = depth_um;
    seen.measurement.command_mV = drive_mV;
    ++seen.measurement.laser_code;
    return (update(plan, watch, seen, true, false).found & bit(Hazard::OffsetOrScale)) != 0;
  }
  // Stays at one depth; true from the tick in which it is named.
  int ticks_until_named(std::int32_t depth_um, std::int32_t drive_mV = 4'000'000) {
    for (int i = 1; i <= 40; ++i)
      if (sinks(depth_um, drive_mV)) return i;
    return 0;
  }
};

TEST(SunkNeedle, IsNotBelievedOnceItIsMoreThanSixTenthsBackForTwentySamples) {
  verifies("R-21");
  for (const auto& [back_um, named_after] : {std::pair{600, 0}, {601, 20}, {900, 20}}) {
    for (const Mode mode : {Mode::Active, Mode::Hold}) {
      Needle needle(mode);
      for (int i = 0; i < 30; ++i) EXPECT_FALSE(needle.sinks(2'300));
      EXPECT_EQ(needle.ticks_until_named(2'300 - back_um), named_after) << back_um << name_of(mode);
    }
  }
}

TEST(SunkNeedle, IsWhatABenchMeasures) {
  verifies("R-21");
  Needle needle;
  needle.plan.bench_half_period_ticks = 250;
  for (int i = 0; i < 30; ++i) needle.sinks(2'300);
  EXPECT_EQ(needle.ticks_until_named(1'600), 0);
}

TEST(SunkNeedle, IsMeasuredFromTheSurfaceWhereNothingWasSeenBefore) {
  verifies("R-21");
  EXPECT_EQ(Needle().ticks_until_named(-600, 0), 0);
  EXPECT_EQ(Needle().ticks_until_named(-601, 0), 20);
}

TEST(FrozenCode, IsNoneThatFallsOrRises) {
  verifies("R-19");
  for (const std::int32_t step : {-1, 1}) {
    Needle needle;
    for (int i = 0; i < 60; ++i) {
      needle.seen.measurement.laser_code += step - 1;  // and one more in sinks()
      needle.sinks(2'000, i * 20'000);
      EXPECT_EQ(needle.watch.found & bit(Hazard::SensorFrozen), 0U) << i;
    }
  }
}

TEST(SunkNeedle, MayGoBackWhereTheDriveWasLoweredOrIsMeantToWithdrawIt) {
  verifies("R-21");
  for (const auto& [drive_mV, named_after] : {std::pair{3'799'999, 0}, {3'800'000, 20}, {-3'800'000, 20}}) {
    Needle needle;
    for (int i = 0; i < 30; ++i) needle.sinks(2'300);
    EXPECT_EQ(needle.ticks_until_named(1'600, drive_mV), named_after) << drive_mV;
  }
  for (const Mode mode : {Mode::Armed, Mode::Retract, Mode::Ready}) {
    Needle needle(mode);
    for (int i = 0; i < 30; ++i) needle.sinks(2'300);
    EXPECT_EQ(needle.ticks_until_named(1'600), 0) << name_of(mode);
  }
}

TEST(SunkNeedle, IsMeasuredFromADepthThatTwoSamplesShowed) {
  verifies("R-21");
  Needle needle;
  for (int i = 0; i < 30; ++i) needle.sinks(2'000);
  needle.sinks(2'900);
  EXPECT_EQ(needle.ticks_until_named(2'000), 0) << "one spike";
  needle.sinks(2'650);
  needle.sinks(2'650);
  EXPECT_EQ(needle.ticks_until_named(2'000), 20);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(needle.sinks(2'000));
  EXPECT_FALSE(needle.sinks(2'600)) << "one sample back is enough";
}

TEST(SlowWave, IsNamedAsSoonAsItIsLateWhicheverFlipItIsCountedFrom) {
  verifies("R-23", "R-22");
  // Late by more than 200 ms since the begin of the wave, or since one of the last four flips.
  for (const std::int32_t flips : {0, 1, 2, 3, 4}) {
    for (std::int32_t counted_from = 0; counted_from <= std::min(flips, 3); ++counted_from) {
      for (const std::int64_t late : {200, 201}) {
        Drive drive;
        drive.watch.tick = 9'999, drive.watch.polarity = 1, drive.watch.flips = flips;
        for (std::int32_t i = 0; i < 4; ++i)
          drive.watch.flip_tick[static_cast<std::size_t>(i)] =
              i <= flips ? 10'000 - 250 * (i + 1) - (i == counted_from ? late : 0) : 0;
        drive.ceiling_mV(2'000'000);
        EXPECT_EQ((drive.watch.found & bit(Hazard::WrongFrequency)) != 0, late > 200)
            << flips << " flips, from " << counted_from;
      }
    }
  }
}

TEST(SlowWave, OfAMemoryThatCountsFewerThanNoFlipsIsCountedFromItsBegin) {
  verifies("R-47");
  for (const std::int32_t flips : {-1, -100}) {
    Drive drive;
    drive.watch.tick = 9'999, drive.watch.polarity = 1, drive.watch.flips = flips;
    drive.watch.flip_tick[0] = 9'000;
    drive.ceiling_mV(2'000'000);
    EXPECT_NE(drive.watch.found & bit(Hazard::WrongFrequency), 0U);
  }
}

TEST(SlowWave, BeginsWhereTheDriveReachesAKilovolt) {
  verifies("R-23");
  Drive drive;
  drive.watch.tick = 500;
  drive.ceiling_mV(900'000);
  drive.ceiling_mV(1'000'000);
  EXPECT_EQ(drive.watch.flip_tick[0], 502);
  int ticks = 1;
  while ((drive.watch.found & bit(Hazard::WrongFrequency)) == 0 && ticks < 1'000)
    drive.ceiling_mV(1'000'000), ++ticks;
  EXPECT_EQ(ticks, 452) << "a half-period, 200 ms, and more than that";
}

TEST(SlowWave, IsABenchsOwnAffair) {
  verifies("R-23");
  for (const std::int32_t half_period_ticks : {1, 250}) {
    Drive drive;
    drive.plan.bench_half_period_ticks = half_period_ticks;
    for (int i = 0; i < 600; ++i) drive.ceiling_mV(2'000'000);
    EXPECT_EQ(drive.watch.found & bit(Hazard::WrongFrequency), 0U);
  }
}

TEST(Wave, OfAPatientsPlanIsJudgedInAHoldToo) {
  verifies("R-22", "R-23");
  for (const std::int32_t half_period_ticks : {-1, 0, 1, 250}) {
    Drive drive(Mode::Hold);
    drive.plan.bench_half_period_ticks = half_period_ticks;
    drive.watch.polarity = 1, drive.watch.flips = 4, drive.watch.wrong_frequency = true;
    drive.ceiling_mV(2'000'000);
    EXPECT_EQ(drive.watch.flips, half_period_ticks <= 0 ? 4 : 0);
    EXPECT_EQ((drive.watch.found & bit(Hazard::WrongFrequency)) != 0, half_period_ticks <= 0);
  }
}

}  // namespace
}  // namespace biopsy::safety
