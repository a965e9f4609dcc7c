// Pull that rises while the needle seems to stand still. Inputs: what an assessor's faulty laser shows (a
// constant with noise, a repeated ramp), not codes made for the detector.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace biopsy::safety
