// Pull that rises while the needle seems to stand still. Inputs: what an assessor's faulty laser shows (a
// constant with noise, a repeated ramp), not codes made for the detector.
#include <gtest/gtest.h>

#include <tuple>
#include <utility>

#include "sim/plant/seeded_noise.hpp"
#include "tests/safety/monitor_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

constexpr std::int32_t kStart_mV = 4'000'000;

// |V|, mV, at which the frozen sensor is named while the drive rises by 1 V in each tick; 0: never up to 8
// kV.
std::int32_t named_at_mV(DepthBench& bench, std::int32_t (*depth_um)(int tick)) {
  bench.seen.measurement.command_mV = kStart_mV;
  for (int i = 0; i < 40; ++i) bench.seen.measurement.laser_code = i, bench.sample(depth_um(i));
  for (int i = 40; bench.seen.measurement.command_mV < 8'000'000; ++i) {
    bench.seen.measurement.command_mV += 1'000;
    bench.seen.measurement.laser_code = i;
    bench.sample(depth_um(i));
    if (bench.names(Hazard::SensorFrozen)) return bench.seen.measurement.command_mV;
  }
  return 0;
}

std::int32_t noisy_constant(int tick) {
  return 2'300 + static_cast<std::int32_t>(50.0 * sim::normals(7, static_cast<std::uint64_t>(tick)).first);
}
std::int32_t repeated_ramp(int tick) {
  return 2'000 + tick % 100;
}
std::int32_t following(int tick) {
  return 1'600 + tick / 4;
}

TEST(DepthMonitor, PullWithoutMotionIsNamedWhateverNoiseTheLaserShows) {
  verifies("R-19");
  for (const auto shown : {noisy_constant, repeated_ramp}) {
    DepthBench bench;
    const std::int32_t named_mV = named_at_mV(bench, shown);
    // sqrt(16 + 24) kV = 6.32 kV, and 20 ticks of 1 V.
    EXPECT_NEAR(named_mV, 6'345'000, 10'000);
  }
}

TEST(DepthMonitor, PullThatMovesTheNeedleIsWork) {
  verifies("R-19");
  DepthBench bench;
  EXPECT_EQ(named_at_mV(bench, following), 0);
}

TEST(DepthMonitor, PullOnTheBenchMayHoldAWeightThatStandsStill) {
  verifies("R-19");
  DepthBench bench;
  bench.plan.bench_half_period_ticks = 250;
  EXPECT_EQ(named_at_mV(bench, noisy_constant), 0);
}

// Ticks at this drive and depth until the frozen sensor is named; 0: not in a hundred.
int named_after(DepthBench& bench, std::int32_t drive_V, std::int32_t depth_um) {
  bench.seen.measurement.command_mV = drive_V * 1'000;
  for (int tick = 1; tick <= 100; ++tick) {
    bench.sample(depth_um);
    if (bench.names(Hazard::SensorFrozen)) return tick;
  }
  return 0;
}

// Withdrawn, with a plan whose band lifts the needle by its first millimetre at this drive.
DepthBench at_rest(std::int32_t lifting_V) {
  DepthBench bench(Mode::Ready);
  bench.plan.bands[0] = {0, -100, 0};
  bench.plan.bands[1] = {lifting_V * 1'000, 0, 1'000};
  bench.samples(20, 0);
  bench.seen.permit.mode = Mode::Active;
  return bench;
}

// In kV^2, from whole numbers: 3 * 2.000^2 + 24 = 6.000^2, and 3 * 1.281^2 + 24 = 5.378^2 less a millionth.
TEST(DepthMonitor, PullFromRestMayBeThreeTimesWhatTheBandSaysCouldLiftAndTwentyFourMore) {
  verifies("R-19");
  for (const auto& [lifting_V, drive_V, ticks] : {std::tuple{2'000, 6'000, 0},
                                                  {2'000, 6'001, 20},
                                                  {1'281, 5'377, 0},
                                                  {1'281, 5'378, 20},
                                                  {2'816, 6'912, 0},
                                                  {2'816, 6'913, 20}}) {
    for (const std::int32_t sign : {1, -1}) {
      DepthBench bench = at_rest(lifting_V);
      EXPECT_EQ(named_after(bench, sign * drive_V, 0), ticks) << lifting_V << ' ' << drive_V;
    }
  }
}

// 7^2 - 5^2 = 24.
TEST(DepthMonitor, PullBeyondWhatMadeTheDeepestDepthMayBeTwentyFourSquareKilovolts) {
  verifies("R-19");
  for (const auto& [drive_V, ticks] : {std::pair{7'000, 0}, {7'001, 20}}) {
    DepthBench bench = at_rest(1'000);
    EXPECT_EQ(named_after(bench, 5'000, 2'000), 0);
    EXPECT_EQ(named_after(bench, drive_V, 2'000), ticks) << drive_V;
  }
}

// At 5 kV it stands at 2 mm; what 7 kV then shows decides whether 7.5 kV is pull without motion.
TEST(DepthMonitor, PullCountsAsWorkWhereTheNeedleCameForwardByMoreThanATenthOfAMillimetre) {
  verifies("R-19");
  for (const auto& [forward_um, ticks] : {std::pair{0, 20}, {100, 20}, {101, 0}}) {
    DepthBench bench = at_rest(1'000);
    EXPECT_EQ(named_after(bench, 5'000, 2'000), 0);
    EXPECT_EQ(named_after(bench, 7'000, 2'000 + forward_um), 0);
    EXPECT_EQ(named_after(bench, 7'500, 2'000 + forward_um), ticks) << forward_um;
  }
}

// Two procedures one after the other: the second begins where the first did.
TEST(DepthMonitor, PullIsMeasuredAnewOnceTheNeedleWasLetBack) {
  verifies("R-19");
  const auto second_procedure = [] {
    DepthBench bench = at_rest(2'000);
    named_after(bench, 5'000, 3'000);
    bench.seen.permit.mode = Mode::Ready;
    named_after(bench, 0, 0);
    bench.seen.permit.mode = Mode::Active;
    return bench;
  };
  DepthBench still = second_procedure(), below = second_procedure(), follows = second_procedure();
  EXPECT_EQ(named_after(below, 6'000, 0), 0);
  EXPECT_EQ(named_after(still, 6'001, 0), 20) << "the first one's pull excuses nothing";
  EXPECT_EQ(named_after(follows, 5'000, 1'500), 0);
  EXPECT_EQ(named_after(follows, 6'500, 1'500), 0) << "less deep than the first, and yet it moved";
}

}  // namespace
}  // namespace biopsy::safety
