// Friction may leave the needle short of its place at 0 V: it is called back only when it is measured there.
#include <gtest/gtest.h>

#include "tests/safety/monitor_bench.hpp"
#include "tests/safety/situation.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

TEST(Supervisor, IsReadyWithAPatientOnlyWithTheNeedleBack) {
  verifies("R-55");
  for (const bool bench : {false, true})
    for (const bool back : {false, true}) {
      Moment safe(Mode::Safe), ready(Mode::Ready);
      for (Moment* moment : {&safe, &ready}) {
        if (bench) moment->plan.bench_half_period_ticks = 250;
        moment->input.evidence.needle_back = back;
      }
      EXPECT_EQ(safe.mode(), back || bench ? Mode::Ready : Mode::Safe);
      EXPECT_EQ(ready.mode(), back || bench ? Mode::Ready : Mode::Safe);
      ready.input.local_arm = true;
      EXPECT_EQ(ready.mode(), back || bench ? Mode::Armed : Mode::Safe);
      safe.input.local_arm = true;
      EXPECT_TRUE(back || bench || safe.refusal() == Refusal::NeedleOut);
    }
}

// What keeps the robot from being armed is what its operator is told.
TEST(Supervisor, RefusesToArmWithTheReasonThatHolds) {
  verifies("R-55");
  struct Case {
    Mode mode;
    bool back, zero;
    Refusal refusal;
  };
  for (const Case& c : {Case{Mode::Safe, false, true, Refusal::NeedleOut},
                        {Mode::Safe, true, true, Refusal::NotReady},
                        {Mode::Ready, false, true, Refusal::NeedleOut},
                        {Mode::Ready, true, false, Refusal::VoltageLeft},
                        {Mode::Ready, false, false, Refusal::VoltageLeft},
                        {Mode::Ready, true, true, Refusal::None},
                        {Mode::Boot, false, true, Refusal::NotReady},
                        {Mode::Armed, false, true, Refusal::NotReady},
                        {Mode::Active, false, false, Refusal::NotReady},
                        {Mode::Hold, false, false, Refusal::NotReady}}) {
    Moment moment(c.mode);
    moment.input.local_arm = true;
    moment.input.evidence.needle_back = c.back, moment.input.evidence.zero_volts = c.zero;
    EXPECT_EQ(moment.refusal(), c.refusal) << name_of(c.mode) << c.back << c.zero;
  }
}

TEST(DepthMonitor, NeedleIsBackWithinATenthOfAMillimetreEitherWayAndSeen) {
  verifies("R-55");
  for (const std::int32_t sign : {1, -1}) {
    DepthBench bench;
    const auto back = [&](std::int32_t depth_um) {
      bench.samples(8, sign * depth_um);
      return update(bench.plan, bench.monitor, bench.seen, LinkFindings{.fresh = true}, bench.zero_volts)
          .needle_back;
    };
    EXPECT_TRUE(back(100));
    EXPECT_FALSE(back(102));
    EXPECT_TRUE(back(0));
    bench.seen.measurement.laser_valid = false;
    bool blind = true;
    for (int i = 0; i < 3; ++i)
      blind = update(bench.plan, bench.monitor, bench.seen, LinkFindings{.fresh = true}, true).needle_back;
    EXPECT_FALSE(blind);
  }
}

// 27 um of noise and nothing else must not make a ready robot unready: half an hour.
TEST(DepthMonitor, NoiseOfTheLaserDoesNotMoveANeedleAway) {
  verifies("R-55");
  DepthBench bench;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 27.0);
  for (int i = 0; i < 1'800'000; ++i) {
    bench.sample(static_cast<std::int32_t>(std::lround(noise(random))));
    ASSERT_TRUE(bench.monitor.needle_back || i < 8) << i;
  }
}

}  // namespace
}  // namespace biopsy::safety
