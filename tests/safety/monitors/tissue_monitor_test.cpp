// How far the needle is from where the plan expects it at the mean drive.
#include "safety/monitors/tissue_monitor.hpp"

#include <gtest/gtest.h>

#include "tests/safety/plan.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

TEST(TissueMonitor, CutsADepthAtAMetreAndADriveAtItsLimit) {
  verifies("R-27", "R-32");
  for (const std::int32_t sign : {1, -1}) {
    TissueMonitor monitor;
    Measurement m;
    m.command_mV = sign * 9'000'000;
    m.depth_um = sign * 2'000'000;
    EXPECT_EQ(tissue_residual_um(three_step_plan(), monitor, m), sign > 0 ? 999'892 : 999'907);
    EXPECT_EQ(monitor.mean_drive_mV, 15'625);
  }
}

TEST(TissueMonitor, FindsNothingWhereTheDepthIsInsideTheBandOfTheMeanDrive) {
  verifies("R-32");
  const PlanFacts plan = three_step_plan();
  TissueMonitor monitor;
  Measurement m;
  m.depth_um = 2'000;
  m.command_mV = -4'000'000;
  std::int32_t residual_um = 0;
  for (int i = 0; i < 10'000; ++i) residual_um = tissue_residual_um(plan, monitor, m);
  EXPECT_EQ(residual_um, 0);
  EXPECT_NEAR(monitor.mean_drive_mV, 4'000'000, kMean_ticks);
}

TEST(TissueMonitor, MeasuresTheWayToTheNearerEdgeOfTheBand) {
  verifies("R-27", "R-32");
  const PlanFacts plan = three_step_plan();
  TissueMonitor monitor{.mean_drive_mV = 4'000'000};
  Measurement m;
  m.command_mV = 4'000'000;
  m.depth_um = 2'900;
  EXPECT_EQ(tissue_residual_um(plan, monitor, m), 600);
  m.depth_um = 1'000;
  EXPECT_EQ(tissue_residual_um(plan, monitor, m), 700);
}

TEST(TissueMonitor, FollowsTheDriveByOneIn512) {
  verifies("R-32");
  TissueMonitor monitor;
  Measurement m;
  m.command_mV = -512'000;
  tissue_residual_um(three_step_plan(), monitor, m);
  EXPECT_EQ(monitor.mean_drive_mV, 1'000);
  tissue_residual_um(three_step_plan(), monitor, m);
  EXPECT_EQ(monitor.mean_drive_mV, 1'998);
}

TEST(TissueMonitor, GivesTheWayToTheNearerEdgeOfTheBandAndNothingInside) {
  for (const auto& [depth_um, residual_um] :
       {std::pair{-103, 3}, {-101, 1}, {-100, 0}, {0, 0}, {100, 0}, {101, 1}}) {
    TissueMonitor monitor;
    Measurement m;
    m.depth_um = depth_um;
    EXPECT_EQ(tissue_residual_um(three_step_plan(), monitor, m), residual_um);
  }
}

}  // namespace
}  // namespace biopsy::safety
