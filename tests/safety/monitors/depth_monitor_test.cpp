// The depth monitor, sample by sample and to the micrometre, against arithmetic done another way.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>
#include <vector>

#include "tests/safety/monitor_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

// Eight samples at one depth, then eight `rise_um` deeper: a known velocity.
std::int32_t move(DepthBench& bench, std::int32_t from_um, std::int32_t rise_um) {
  bench.samples(20, from_um);
  bench.samples(8, from_um + rise_um);
  return from_um + rise_um;
}

TEST(DepthHistory, KnowsVelocityAndAdvanceOfAnyCourse) {
  std::mt19937 random(4);
  DepthHistory history;
  std::vector<std::int32_t> all(40, -300);
  history.fill(-300);
  for (int i = 0; i < 200; ++i) {
    all.push_back(static_cast<std::int32_t>(random() % 20'000) - 10'000);
    history.push(all.back());
    const auto sum = [&](int back) {
      std::int64_t total = 0;
      for (int k = 0; k < 8; ++k) total += all[all.size() - 1 - back - k];
      return total;
    };
    ASSERT_EQ(history.velocity_um_per_s(), (sum(0) - sum(8)) * 1'000 / 64) << i;
    ASSERT_EQ(history.advance_um(), all.back() - all[all.size() - 11]) << i;
  }
}

TEST(DriveWindow, KnowsTheLeastAndMostOfTenBlocksAndTheOneUnderWay) {
  std::mt19937 random(9);
  DriveWindow window;
  std::deque<std::pair<std::int32_t, std::int32_t>> finished(10, {0, 0});
  std::vector<std::int32_t> under_way;
  for (int i = 0; i < 2'000; ++i) {
    under_way.push_back(1'000 + 500 * (i / 50 % 13) + static_cast<std::int32_t>(random() % 400));
    window.push(under_way.back());
    auto [low, high] = std::minmax_element(under_way.begin(), under_way.end());
    std::int32_t least = *low, most = *high;
    if (under_way.size() == 50) finished.pop_front(), finished.emplace_back(least, most), under_way.clear();
    for (const auto& [block_low, block_high] : finished)
      least = std::min(least, block_low), most = std::max(most, block_high);
    ASSERT_EQ(window.lowest_mV(), least) << i;
    ASSERT_EQ(window.highest_mV(), most) << i;
  }
}

TEST(DepthMonitor, StoppingPointIsDepthPlusWayOfReactionPlusWayOfBraking) {
  verifies("R-16");
  for (const std::int32_t rise_um :
       {0, 1, 8, 13, 64, 200, 201, 999, 2'048, 4'000, 100'000, 127'999, 128'000}) {
    for (const std::int32_t odd : {0, 1}) {
      DepthBench bench;
      bench.samples(20, -rise_um);
      bench.samples(7, 0);
      const std::int32_t last = -odd;  // makes every sum of eight possible
      const std::int64_t v = (std::int64_t{8} * rise_um + last) * 125 / 8;
      const std::int64_t stopping = v > 0 ? last + v * 5 / 1'000 + v * v / 10'000'000 : last;
      bench.plan.depth_max_um = static_cast<std::int32_t>(stopping);
      bench.monitor.over_ticks = 1;
      bench.sample(last);
      EXPECT_FALSE(bench.names(Hazard::OverDepth)) << rise_um;
      bench = DepthBench{};
      bench.samples(20, -rise_um);
      bench.samples(7, 0);
      bench.plan.depth_max_um = static_cast<std::int32_t>(stopping - 1);
      bench.monitor.over_ticks = 1;
      bench.sample(last);
      EXPECT_TRUE(bench.names(Hazard::OverDepth)) << rise_um;
    }
  }
}

TEST(DepthMonitor, StoppingPointOfANeedleThatComesBackIsWhereItIs) {
  DepthBench bench;
  const std::int32_t depth_um = move(bench, 4'500, -400);
  bench.plan.depth_max_um = depth_um;
  bench.samples(2, depth_um);
  EXPECT_FALSE(bench.names(Hazard::OverDepth));
  bench.plan.depth_max_um = depth_um - 1;
  bench.samples(2, depth_um);
  EXPECT_TRUE(bench.names(Hazard::OverDepth));
}

TEST(DepthMonitor, DepthLimitsTakeTwoSamplesOverThemAndNotOne) {
  verifies("R-14", "R-16", "R-31");
  DepthBench bench;
  bench.seen.permit.depth_max_um = 3'600;
  for (const auto& [hazard, limit_um] :
       {std::pair{Hazard::StepDepth, 3'600}, {Hazard::OverDepth, 4'000}, {Hazard::HardOverDepth, 5'000}}) {
    bench.monitor = {};
    bench.samples(20, limit_um);
    EXPECT_FALSE(bench.names(hazard)) << "at the limit " << limit_um;
    bench.monitor = {};
    bench.sample(limit_um + 1);
    EXPECT_FALSE(bench.names(hazard)) << "one sample over " << limit_um;
    bench.sample(limit_um + 1);
    EXPECT_TRUE(bench.names(hazard)) << limit_um;
  }
}

TEST(DepthMonitor, DepthLimitsAStoppingPointMoreThanTwoMillimetresBeyondThePlanIsTheHardLimit) {
  verifies("R-14");
  for (const std::int32_t beyond_um : {0, 1}) {
    DepthBench bench;
    move(bench, 0, 2'048);  // 256 mm/s: 1280 um to react, 6553 um to stop
    bench.plan.depth_max_um = 2'048 + 1'280 + 6'553 - 2'000 - beyond_um;
    bench.monitor.history = {};
    bench.monitor.history.fill(0);
    for (int i = 0; i < 7; ++i) bench.monitor.history.push(2'048);
    bench.monitor.hard_ticks = 1;
    bench.sample(2'048);
    EXPECT_EQ(bench.names(Hazard::HardOverDepth), beyond_um == 1);
  }
}

TEST(DepthMonitor, DepthLimitsOfAStepHoldWhileItIsDrivenOnly) {
  for (const Mode mode : {Mode::Armed, Mode::Hold, Mode::Retract}) {
    DepthBench bench(mode);
    bench.seen.permit.depth_max_um = 100;
    bench.samples(5, 200);
    EXPECT_FALSE(bench.names(Hazard::StepDepth));
  }
}

TEST(DepthMonitor, BreakThroughIsMoreThanEightTenthsWithinTenTicksTwice) {
  verifies("R-17");
  for (const Mode mode : {Mode::Active, Mode::Hold}) {
    DepthBench bench(mode);
    bench.samples(20, 100);
    bench.samples(5, 900);
    EXPECT_FALSE(bench.names(Hazard::PopThrough)) << "0.8 mm";
    bench.samples(20, 100);
    bench.sample(901);
    EXPECT_FALSE(bench.names(Hazard::PopThrough)) << "one sample";
    bench.sample(901);
    EXPECT_TRUE(bench.names(Hazard::PopThrough));
    bench.sample(2'000);
    EXPECT_TRUE(bench.names(Hazard::PopThrough)) << "further than the limit";
  }
}

TEST(DepthMonitor, FallingBackIsFasterThanFiftyMillimetresASecond) {
  verifies("R-15");
  for (const Mode mode : {Mode::Active, Mode::Hold}) {
    DepthBench bench(mode);
    move(bench, 3'000, -400);
    EXPECT_FALSE(bench.names(Hazard::FastDrop)) << "50 mm/s";
    bench.samples(20, 3'000);
    bench.samples(7, 2'600);
    bench.sample(2'599);
    EXPECT_TRUE(bench.names(Hazard::FastDrop));
  }
}

TEST(DepthMonitor, FallingBackAndBreakingThroughCountOnlyWhereTheNeedleIsLifted) {
  for (const Mode mode :
       {Mode::Boot, Mode::Safe, Mode::Ready, Mode::Armed, Mode::Retract, Mode::Trip, Mode::Lock}) {
    DepthBench bench(mode);
    move(bench, 100, 1'000);
    EXPECT_FALSE(bench.names(Hazard::PopThrough)) << static_cast<int>(mode);
    move(bench, 3'000, -1'000);
    EXPECT_FALSE(bench.names(Hazard::FastDrop)) << static_cast<int>(mode);
  }
}

TEST(DepthMonitor, FrozenCodeIsTheSameForTwentyTicksWhileTheDriveMovesByMoreThanTwoHundredVolts) {
  verifies("R-19");
  for (const std::int32_t drive_mV : {1'200'000, 1'200'001, -1'200'000, -1'200'001, 799'999, 800'000}) {
    const bool moved = std::abs(std::abs(drive_mV) - 1'000'000) > 200'000;
    DepthBench bench;
    bench.seen.measurement.command_mV = 1'000'000;
    bench.sample(500);
    bench.seen.measurement.command_mV = drive_mV;
    const auto same_code = [&] {
      return update(bench.plan, bench.monitor, bench.seen, LinkFindings{.fresh = true}, false).found;
    };
    for (int i = 0; i < 19; ++i) EXPECT_EQ(same_code() & bit(Hazard::SensorFrozen), 0U) << i;
    EXPECT_EQ(same_code() != 0, moved) << drive_mV;
    bench.seen.measurement.command_mV = 1'000'000;
    EXPECT_EQ(same_code() != 0, moved) << "back again, but it did move";
    EXPECT_EQ(bench.sample(500), 0U) << "another code";
  }
}

TEST(DepthMonitor, FrozenCodeCountsTheDriveByItsAmountUpToItsLimit) {
  for (const std::int32_t drive_mV : {-9'000'000, -8'000'001, -2, -1, 0, 1, 2, 8'000'001, 9'000'000}) {
    DepthBench bench;
    bench.seen.measurement.command_mV = drive_mV;
    bench.sample(0);
    EXPECT_EQ(bench.monitor.frozen_low_mV, std::min(std::abs(drive_mV), 8'000'000));
    EXPECT_EQ(bench.monitor.frozen_high_mV, std::min(std::abs(drive_mV), 8'000'000));
  }
}

TEST(DepthMonitor, PlausibilityToleratesAMillimetreBesideTheBandAndMoreForFortyNineTicks) {
  verifies("R-21");
  const auto ticks_until_named = [](std::int32_t depth_um) {
    DepthBench bench(Mode::Ready);  // at 0 V: -0.1 to 0.1 mm
    for (int i = 1; i <= 200; ++i) {
      bench.sample(depth_um);
      if (bench.names(Hazard::OffsetOrScale)) return i;
    }
    return 0;
  };
  EXPECT_EQ(ticks_until_named(1'100), 0);
  EXPECT_EQ(ticks_until_named(1'101), 50);
  EXPECT_EQ(ticks_until_named(-1'100), 0);
  EXPECT_EQ(ticks_until_named(-1'101), 50);
}

TEST(DepthMonitor, PlausibilityIsLookedUpAnewWhenTheDriveOrThePlanChanges) {
  verifies("R-21");
  DepthBench bench(Mode::Ready);
  bench.sample(0);
  EXPECT_EQ(bench.monitor.range.high_um, 100);
  bench.plan.bands[0].high_um = 300;
  bench.sample(0);
  EXPECT_EQ(bench.monitor.range.high_um, 100) << "the same plan has the same bands";
  ++bench.plan.plan_tag;
  bench.sample(0);
  EXPECT_EQ(bench.monitor.range.high_um, 300);
  bench.plan.bands[0].high_um = 200;
  bench.plan.plan_tag -= 2;
  bench.sample(0);
  EXPECT_EQ(bench.monitor.range.high_um, 200) << "a smaller tag is another plan as well";
  bench.seen.measurement.command_mV = 4'000'000;
  bench.sample(0);
  EXPECT_EQ(bench.monitor.range.low_um, -100) << "0 V was in the window";
  EXPECT_EQ(bench.monitor.range.high_um, 2'300);
  bench.samples(700, 2'000);
  EXPECT_EQ(bench.monitor.range.low_um, 1'700) << "and has left it";
  bench.seen.measurement.command_mV = 0;
  bench.sample(2'000);
  EXPECT_EQ(bench.monitor.range.low_um, -100);
  EXPECT_EQ(bench.monitor.range.high_um, 2'300);
}

TEST(DepthMonitor, NeedleHomeIsAboveOneMillimetreAndMissedAfterHalfASecondAtZeroVolts) {
  verifies("R-02");
  const auto home = [](DepthBench& bench) {
    return update(bench.plan, bench.monitor, bench.seen, LinkFindings{.fresh = false}, true).needle_home;
  };
  DepthBench bench(Mode::Safe);
  bench.zero_volts = true;
  bench.sample(999);
  EXPECT_TRUE(home(bench));
  bench.samples(499, 1'000);
  EXPECT_FALSE(home(bench));
  EXPECT_FALSE(bench.names(Hazard::NeedleNotBack));
  bench.sample(1'000);
  EXPECT_TRUE(bench.names(Hazard::NeedleNotBack));
  bench.zero_volts = false;
  bench.sample(1'000);
  EXPECT_FALSE(bench.names(Hazard::NeedleNotBack)) << "the drive is on";
}

TEST(DepthMonitor, LaserDropoutIsThreeSamplesWithoutATargetAndTheNeedleIsNowhereThen) {
  verifies("R-20");
  DepthBench bench;
  bench.samples(20, 100);
  bench.seen.measurement.laser_valid = false;
  const auto lost = [&] {
    return update(bench.plan, bench.monitor, bench.seen, LinkFindings{.fresh = true}, false);
  };
  EXPECT_EQ(lost().found, 0U);
  EXPECT_TRUE(lost().needle_home) << "where it was seen last";
  const DepthFindings third = lost();
  EXPECT_EQ(third.found, bit(Hazard::LaserDropout));
  EXPECT_FALSE(third.needle_home);
  bench.seen.measurement.laser_valid = true;
  EXPECT_EQ(bench.sample(3'000), 0U) << "found again elsewhere: no velocity is made of that";
  EXPECT_EQ(bench.monitor.history.velocity_um_per_s(), 0);
  EXPECT_EQ(bench.monitor.history.advance_um(), 0);
}

TEST(DepthMonitor, LaserDropoutThatComesAndGoesInTwoOfThreeSamplesIsNamedAndInOneOfThreeIsNot) {
  for (const bool often : {true, false}) {
    DepthBench bench;
    bench.samples(20, 2'000);
    bool named = false;
    for (int i = 0; i < 60; ++i) {
      bench.seen.measurement.laser_valid = (i % 3 == 0) == often;
      named =
          named || (update(bench.plan, bench.monitor, bench.seen, LinkFindings{.fresh = true}, false).found &
                    bit(Hazard::LaserDropout)) != 0;
    }
    EXPECT_EQ(named, often);
  }
}

TEST(DepthMonitor, LaserDropoutOfTwoSamplesKeepsTheHistory) {
  DepthBench bench;
  bench.samples(20, 100);
  bench.seen.measurement.laser_valid = false;
  for (int i = 0; i < 2; ++i)
    update(bench.plan, bench.monitor, bench.seen, LinkFindings{.fresh = true}, false);
  bench.seen.measurement.laser_valid = true;
  bench.sample(400);
  EXPECT_EQ(bench.monitor.history.advance_um(), 300);
}

TEST(DepthMonitor, DepthOfASensorBeyondAMetreIsCutThere) {
  DepthBench bench;
  bench.sample(2'000'000);
  EXPECT_EQ(bench.monitor.history.newest, 8'000'000);
  bench.monitor = {};
  bench.sample(-2'000'000);
  EXPECT_EQ(bench.monitor.history.newest, -8'000'000);
}

}  // namespace
}  // namespace biopsy::safety
