// The needle's depth and the plan's model of it, condition by condition.
#include <gtest/gtest.h>

#include "safety/monitors/tissue_monitor.hpp"
#include "tests/safety/rig.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

bool names(const Rig& rig, Hazard hazard) {
  return (rig.evidence.hazards() & bit(hazard)) != 0;
}

TEST(NeedleHome, IsNotKnownWithoutALaserThoughItWasHomeWhenLastSeen) {
  verifies("R-02", "R-20");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  ASSERT_TRUE(rig.evidence.needle_home);
  rig.on_measurement = [](Measurement& m) { m.laser_valid = false; };
  rig.run(2);
  EXPECT_TRUE(rig.evidence.needle_home) << "single samples may be lost";
  rig.tick();
  EXPECT_FALSE(rig.evidence.needle_home);
  EXPECT_TRUE(names(rig, Hazard::LaserDropout));
}

TEST(Plausibility, ADepthTooSmallForTheDriveIsNamedAsOneTooLarge) {
  verifies("R-21");
  for (const std::int32_t off_um : {-1'600, 1'600}) {
    Rig rig;
    rig.wanted_mV = 4'000'000;
    ASSERT_TRUE(rig.go_active());
    rig.on_measurement = [&, um = 0](Measurement& m) mutable {
      if (std::abs(um) < std::abs(off_um)) um += off_um / 100;
      m.depth_um += um;
    };
    EXPECT_LE(rig.ticks_until([&] { return names(rig, Hazard::OffsetOrScale); }, 200), 200) << off_um;
  }
}

TEST(Plausibility, IsJudgedByTheBandsOfThePlanInUse) {
  verifies("R-21");
  Rig rig;
  ASSERT_TRUE(rig.go_ready());
  rig.run(600);  // at rest: the same drive all the time
  ASSERT_FALSE(names(rig, Hazard::OffsetOrScale));
  rig.plan.bands[0] = {0, 3'000, 4'000};  // another plan, for which a needle at home is wrong
  ++rig.plan.plan_tag;
  EXPECT_LE(rig.ticks_until([&] { return names(rig, Hazard::OffsetOrScale); }, 60), 60);
}

TEST(TissueMonitor, FindsNothingWhereTheDepthIsInsideTheBandOfTheMeanDrive) {
  verifies("R-32");
  const PlanFacts plan = three_stage_plan();
  TissueMonitor watch;
  Measurement m;
  m.depth_um = 2'000;
  m.command_mV = -4'000'000;
  std::int32_t residual_um = 0;
  for (int i = 0; i < 10'000; ++i) residual_um = tissue_residual_um(plan, watch, m);
  EXPECT_EQ(residual_um, 0);
  EXPECT_NEAR(watch.mean_drive_mV, 4'000'000, kMean_ticks);
}

TEST(TissueMonitor, MeasuresTheWayToTheNearerEdgeOfTheBand) {
  verifies("R-27", "R-32");
  const PlanFacts plan = three_stage_plan();
  TissueMonitor watch{.mean_drive_mV = 4'000'000};
  Measurement m;
  m.command_mV = 4'000'000;
  m.depth_um = 2'900;
  EXPECT_EQ(tissue_residual_um(plan, watch, m), 600);
  m.depth_um = 1'000;
  EXPECT_EQ(tissue_residual_um(plan, watch, m), 700);
}

}  // namespace
}  // namespace biopsy::safety
