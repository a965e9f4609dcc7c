// Two lasers, sample by sample. The shapes of the faults are those of sensors that failed elsewhere (still,
// replayed, drifting, scaled, late); none is made from the monitor's threshold. The true needle is a table of
// motions.
#include "safety/monitors/agreement_monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "tests/safety/rig.hpp"

namespace biopsy::safety {
namespace {

struct AgreementBench {
  PlanFacts plan = three_step_plan();
  AgreementMonitor monitor;
  Measurement m;

  AgreementBench() { m.laser_valid = m.laser_b_valid = true; }
  HazardSet sample(std::int32_t a_um, std::int32_t b_um) {
    m.depth_um = a_um, m.depth_b_um = b_um;
    return update(plan, monitor, m, true);
  }
  HazardSet samples(int count, std::int32_t a_um, std::int32_t b_um) {
    HazardSet found = 0;
    for (int i = 0; i < count; ++i) found = sample(a_um, b_um);
    return found;
  }
};

const HazardSet kDiffers = bit(Hazard::OffsetOrScale), kBlind = bit(Hazard::LaserDropout);

TEST(AgreementMonitor, NamesLasersThatAreApartForTenSamplesInEitherDirection) {
  for (const std::int32_t sign : {-1, 1}) {
    AgreementBench bench;
    EXPECT_EQ(bench.samples(50, 2'000, 2'000 + sign * 300), 0U);
    EXPECT_EQ(bench.samples(9, 2'000, 2'000 + sign * 301), 0U);
    EXPECT_EQ(bench.samples(1, 2'000, 2'000 + sign * 301), kDiffers);
    EXPECT_EQ(bench.samples(1, 2'000, 2'000), 0U);
  }
}

TEST(AgreementMonitor, SpikesAreNotAFault) {
  AgreementBench bench;
  for (int i = 0; i < 1'000; ++i) EXPECT_EQ(bench.sample(2'000, i % 5 == 0 ? 9'000 : 2'000), 0U);
}

// The needle and another surface by turns, 1.5 mm apart: a sound sample in between hides nothing.
TEST(AgreementMonitor, NamesALaserThatShowsTheNeedleAndAnotherSurfaceByTurns) {
  const auto samples_until_named = [](int apart, int together) {
    AgreementBench bench;
    for (int i = 0; i < 1'000; ++i)
      if (bench.sample(i % (apart + together) < apart ? 1'000 : 2'500, 2'500) == kDiffers) return i + 1;
    return 0;
  };
  EXPECT_EQ(samples_until_named(1'000, 1), 10);
  for (const auto& [apart, together] : {std::pair{9, 1}, {5, 5}, {1, 1}, {1, 3}, {3, 8}}) {
    const int samples = samples_until_named(apart, together);
    EXPECT_GT(samples, 0) << apart << " of " << apart + together;
    EXPECT_LE(samples, 200) << apart << " of " << apart + together;
  }
  EXPECT_EQ(samples_until_named(1, 4), 0) << "spikes";
}

TEST(AgreementMonitor, ASecondLaserThatLosesItsTargetTwiceInThreeSamplesIsBlind) {
  AgreementBench bench;
  bench.samples(20, 2'000, 2'000);
  HazardSet found = 0;
  for (int i = 0; i < 30; ++i) {
    bench.m.laser_b_valid = i % 3 == 0;
    found |= bench.sample(2'000, 2'000);
  }
  EXPECT_EQ(found, kBlind);
}

TEST(AgreementMonitor, ExtremeReadingsDoNotOverflow) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max(), kLeast = -kMost - 1;
  EXPECT_EQ(AgreementBench().samples(10, kLeast, kMost), kDiffers);
  EXPECT_EQ(AgreementBench().samples(10, kMost, kLeast), kDiffers);
}

TEST(AgreementMonitor, ASecondLaserWithoutATargetIsADropoutAfterThreeSamples) {
  AgreementBench bench;
  EXPECT_EQ(bench.samples(5, 2'000, 2'000), 0U);
  bench.m.laser_b_valid = false;
  EXPECT_EQ(bench.samples(2, 2'000, 2'000), 0U);
  EXPECT_EQ(bench.samples(1, 2'000, 2'000), kBlind);
  bench.m.laser_b_valid = true;
  EXPECT_EQ(bench.samples(1, 2'000, 2'000), 0U);
}

TEST(AgreementMonitor, UntilTheSecondLaserWasSeenItCountsAsBlind) {
  AgreementBench bench;
  bench.m.laser_b_valid = false;
  EXPECT_EQ(bench.samples(1, 0, 0), kBlind);
  EXPECT_EQ(update(bench.plan, bench.monitor, bench.m, false), kBlind);  // no new measurement: it stands
}

TEST(AgreementMonitor, AFlickeringLaserHidesNoDifference) {
  AgreementBench bench;
  HazardSet found = 0;
  for (int i = 0; i < 60; ++i) {
    bench.m.laser_valid = i % 2 == 0;
    bench.m.laser_b_valid = i % 4 != 1;
    found |= bench.sample(2'000, 3'000);
  }
  EXPECT_NE(found & kDiffers, 0U);
}

// Nine samples apart, one of the two blind for one more: it neither is the tenth nor is it a sound one.
TEST(AgreementMonitor, ASampleOfOneLaserAloneCountsNeitherWay) {
  for (const bool a_is_blind : {true, false}) {
    AgreementBench bench;
    bench.samples(5, 2'000, 2'000);
    bench.samples(9, 2'000, 3'000);
    (a_is_blind ? bench.m.laser_valid : bench.m.laser_b_valid) = false;
    EXPECT_EQ(bench.sample(2'000, 3'000), 0U);
    EXPECT_EQ(bench.sample(2'000, 2'000), 0U);
    bench.m.laser_valid = bench.m.laser_b_valid = true;
    EXPECT_EQ(bench.sample(2'000, 3'000), kDiffers);
  }
}

TEST(AgreementMonitor, WithoutAPatientOneLaserIsEnough) {
  AgreementBench bench;
  bench.plan.bench_half_period_ticks = 500;
  bench.m.laser_b_valid = false;
  EXPECT_EQ(bench.samples(20, 2'000, 0), 0U);
  bench.m.laser_b_valid = true;
  EXPECT_EQ(bench.samples(20, 2'000, 0), 0U);
  EXPECT_EQ(update(bench.plan, bench.monitor, bench.m, false), 0U) << "nor is it found when none arrives";
}

TEST(AgreementMonitor, AnOldSampleIsNotCountedAgain) {
  AgreementBench bench;
  bench.samples(9, 2'000, 3'000);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(update(bench.plan, bench.monitor, bench.m, false), 0U);
  EXPECT_EQ(bench.samples(1, 2'000, 3'000), kDiffers);
}

// What the first laser shows of a needle that moves at 0.5 mm/s from 1 mm on, with 30 um of noise on both.
using Shown = std::function<double(double true_mm, double since_s)>;

double error_when_named_mm(const Shown& shown) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 30.0);
  AgreementBench bench;
  for (int tick = 0; tick < 20'000; ++tick) {
    const double since_s = tick * 1e-3, true_mm = 1.0 + 0.5 * since_s;
    const auto a_um = static_cast<std::int32_t>(1e3 * shown(true_mm, since_s) + noise(random));
    const auto b_um = static_cast<std::int32_t>(1e3 * true_mm + noise(random));
    if (bench.sample(a_um, b_um) != 0) return std::abs(shown(true_mm, since_s) - true_mm);
  }
  return -1.0;
}

TEST(AgreementMonitor, NoShapeOfFaultIsFurtherOffThanTheBoundWhenItIsNamed) {
  const std::pair<const char*, Shown> kShapes[] = {
      {"still", [](double, double) { return 1.0; }},
      {"replays 100 ms", [](double, double t) { return 1.0 + 0.5 * std::fmod(t, 0.1); }},
      {"scale 0.8", [](double x, double) { return 0.8 * x; }},
      {"scale 1.2", [](double x, double) { return 1.2 * x; }},
      {"drifts back", [](double x, double t) { return x - 0.1 * t; }},
      {"drifts back slowly", [](double x, double t) { return x - 0.02 * t; }},
      {"late by 2 s", [](double x, double t) { return x - 0.5 * std::min(t, 2.0); }},
      {"sign turned", [](double x, double) { return 2.0 - x; }},
      {"parabola", [](double x, double t) { return x - 0.05 * t * t; }}};
  for (const auto& [name, shown] : kShapes) {
    const double off_mm = error_when_named_mm(shown);
    EXPECT_GT(off_mm, 0.0) << name << " is not named";
    EXPECT_LT(off_mm, 0.45) << name;  // the bound, noise, and ten samples
  }
}

TEST(AgreementMonitor, SoundLasersAreNeverNamedInAnHour) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 50.0);  // the worst that is accepted
  AgreementBench bench;
  HazardSet found = 0;
  for (int tick = 0; tick < 3'600'000; ++tick) {
    const double true_um = 2'000.0 + 1'500.0 * std::sin(tick * 1e-3);
    found |= bench.sample(static_cast<std::int32_t>(true_um + noise(random)),
                          static_cast<std::int32_t>(true_um + noise(random)));
  }
  EXPECT_EQ(found, 0U);
}

TEST(AgreementMonitor, IsPartOfTheEvidence) {
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  rig.lasers_agree = false;
  rig.on_measurement = [](Measurement& m) { m.depth_b_um = m.depth_um + 400; };
  rig.run(11);
  EXPECT_NE(rig.evidence.hazards() & kDiffers, 0U);
  EXPECT_EQ(rig.state.mode, Mode::Retract);
}

}  // namespace
}  // namespace biopsy::safety
