#include "sim/scanner/scanner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robot/common/config_error.hpp"
#include "sim/scanner/phantom.hpp"

namespace biopsy::sim {
namespace {

Volume block(double pixel_mm, double slice_mm, float value = 1000.0f) {
  Volume volume;
  volume.grid.size =
      Eigen::Vector3d(40.0 / pixel_mm, 40.0 / pixel_mm, 30.0 / slice_mm).array().round().cast<int>();
  volume.grid.X_SI.linear() = Eigen::Vector3d(pixel_mm, pixel_mm, slice_mm).asDiagonal();
  volume.grid.X_SI.translation() = Point(-20.0, -20.0, -15.0);
  volume.voxels.assign(volume.grid.voxel_count(), value);
  return volume;
}

ScanSettings clean() {
  ScanSettings settings;
  settings.snr = 0.0;
  settings.drift = 0.0;
  return settings;
}

NeedleArtefact needle(double depth_mm, double radius_mm) {
  NeedleArtefact n;
  n.p_SE = Point(-12.0, 0.0, 0.0);
  n.axis_S = Direction::UnitX();
  n.tip_depth = Millimetres(depth_mm);
  n.radius = Millimetres(radius_mm);
  return n;
}

TEST(NeedleArtefact, HasLostHalfOfItsSignalAtTheTipWhateverItsForm) {
  for (double radius : {0.6, 1.5, 6.0})
    for (double edge : {0.15, 0.5})
      for (double roundness : {0.0, 1.0}) {
        NeedleArtefact n = needle(15.0, radius);
        n.edge = Millimetres(edge), n.tip_roundness = roundness, n.tip_bloom = 0.4;
        EXPECT_NEAR(signal_left(n, n.p_SE + 15.0 * n.axis_S), 1.0 - 0.5 * n.loss, 0.06)
            << radius << " " << edge;
        EXPECT_NEAR(signal_left(n, n.p_SE + 10.0 * n.axis_S), 1.0 - n.loss, 0.02);
        EXPECT_DOUBLE_EQ(signal_left(n, n.p_SE + 18.0 * n.axis_S), 1.0);
        EXPECT_NEAR(signal_left(n, n.p_SE - 10.0 * n.axis_S), 1.0 - n.loss, 0.02);
      }
}

// The missing signal, summed over a cross-section, is the area of the void, however thick the voxels are.
TEST(Scanner, DimsAThinNeedleInThickSlicesByTheShareOfTheVoxelItFills) {
  NeedleArtefact thin = needle(20.0, 0.6);
  thin.edge = Millimetres(0.1), thin.loss = 1.0;
  const double area = std::numbers::pi * 0.6 * 0.6;
  for (double slice : {0.5, 3.0}) {
    const Volume planning = block(0.5, slice);
    ScanSettings settings = clean();
    settings.needle = thin;
    const Volume image = scan(planning, settings);
    const int i = 30;  // x = -5, well before the tip
    double missing = 0.0, deepest = 0.0;
    for (int k = 0; k < image.grid.size.z(); ++k)
      for (int j = 0; j < image.grid.size.y(); ++j) {
        const double lost = 1.0 - static_cast<double>(image.at(i, j, k)) / 1000.0;
        missing += lost * 0.5 * slice;
        deepest = std::max(deepest, lost);
      }
    EXPECT_NEAR(missing, area, 0.15 * area) << slice;
    if (slice > 1.0)
      EXPECT_LT(deepest, 0.5);  // 1.2 mm of 3 mm
    else
      EXPECT_GT(deepest, 0.9);
  }
}

TEST(Scanner, MovesTheTissueAsToldWhileTheNeedleStaysWithTheRobot) {
  Volume planning = block(1.0, 1.0, 200.0f);
  const Point spot(4.0, 6.0, -3.0);
  for (int k = 0; k < planning.grid.size.z(); ++k)
    for (int j = 0; j < planning.grid.size.y(); ++j)
      for (int i = 0; i < planning.grid.size.x(); ++i)
        planning.voxels[planning.grid.index(i, j, k)] += static_cast<float>(
            800.0 * std::exp(-0.25 * (planning.grid.X_SI * Eigen::Vector3d(i, j, k) - spot).squaredNorm()));
  ScanSettings settings = clean();
  settings.motion = {Point(-12.0, 0.0, 0.0), {2.0, -1.0, 3.0}, {0.0, 0.0, 5.0}};
  settings.needle = needle(10.0, 1.5);
  const Volume image = scan(planning, settings);
  Point centre = Point::Zero();
  double weight = 0.0;
  for (int k = 0; k < image.grid.size.z(); ++k)
    for (int j = 0; j < image.grid.size.y(); ++j)
      for (int i = 0; i < image.grid.size.x(); ++i) {
        const double over = static_cast<double>(image.at(i, j, k)) - 300.0;
        if (over <= 0.0) continue;
        weight += over;
        centre += over * (image.grid.X_SI * Eigen::Vector3d(i, j, k));
      }
  const double turn = 5.0 * std::numbers::pi / 180.0;
  const Point expected(-12.0 + 16.0 * std::cos(turn) - 6.0 * std::sin(turn) + 2.0,
                       16.0 * std::sin(turn) + 6.0 * std::cos(turn) - 1.0, 0.0);
  EXPECT_LT((centre / weight - expected).norm(), 0.1);
  EXPECT_LT(image.at(12, 20, 15), 20.0f);   // 4 mm along the needle's own axis: still void
  EXPECT_GT(image.at(20, 20, 15), 150.0f);  // 2 mm beyond the tip: tissue
}

TEST(Scanner, AddsRicianNoise) {
  Volume planning = block(1.0, 1.0);
  for (int k = 0; k < 10; ++k)  // air
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 40; ++i) planning.voxels[planning.grid.index(i, j, k)] = 0.0f;
  ScanSettings settings = clean();
  settings.snr = 20.0;  // sigma 50
  const Volume image = scan(planning, settings);
  double air = 0.0, tissue = 0.0, spread = 0.0;
  for (int k : {2, 4, 6, 14, 18, 22})
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 40; ++i) {
        const double value = static_cast<double>(image.at(i, j, k));
        if (k < 10)
          air += value / 4800.0;
        else
          tissue += value / 4800.0, spread += (value - 1000.0) * (value - 1000.0) / 4800.0;
      }
  EXPECT_NEAR(air, 50.0 * std::sqrt(std::numbers::pi / 2.0), 1.5);  // mean of a Rayleigh distribution
  EXPECT_NEAR(tissue, 1000.0 + 50.0 * 50.0 / 2000.0, 3.0);
  EXPECT_NEAR(std::sqrt(spread), 50.0, 2.0);
}

TEST(Scanner, RepeatsItselfForASeedAndDiffersForAnother) {
  const Volume planning = block(1.0, 2.0);
  ScanSettings settings;
  settings.needle = needle(10.0, 1.0);
  const Volume first = scan(planning, settings);
  EXPECT_EQ(first.voxels, scan(planning, settings).voxels);
  settings.seed = 2;
  EXPECT_NE(first.voxels, scan(planning, settings).voxels);
}

TEST(Scanner, DriftStaysWithinItsBoundAndGhostsComeBack) {
  const Volume planning = block(1.0, 2.0);
  ScanSettings settings = clean();
  settings.drift = 0.2;
  const Volume drifted = scan(planning, settings);
  const auto [least, most] = std::minmax_element(drifted.voxels.begin(), drifted.voxels.end());
  EXPECT_GE(*least, 800.0f);
  EXPECT_LE(*most, 1200.0f);
  EXPECT_GT(*most - *least, 20.0f);
  settings = clean();
  settings.needle = needle(10.0, 2.0);
  settings.ghost = 0.1, settings.ghost_shift_voxels = 10;
  const Volume ghosted = scan(planning, settings);
  EXPECT_NEAR(ghosted.at(12, 30, 8), 1000.0 + 0.1 * 30.0, 15.0);  // the ghost of the void
  EXPECT_NEAR(ghosted.at(12, 5, 8), 1100.0, 1.0);
}

TEST(Scanner, RendersOnAnotherGridAndLeavesAirOutsideThePlanningVolume) {
  const Volume planning = block(1.0, 2.0);
  ScanSettings settings = clean();
  Grid grid = planning.grid;
  grid.X_SI.translation().x() += 30.0;
  settings.grid = grid;
  const Volume image = scan(planning, settings);
  EXPECT_NEAR(image.at(2, 20, 7), 1000.0, 1e-3);
  EXPECT_EQ(image.at(35, 20, 7), 0.0f);
}

TEST(Scanner, RefusesEmptyVolumesAndNumbersThatAreNone) {
  EXPECT_THROW(scan(Volume{}, clean()), ConfigError);
  ScanSettings settings = clean();
  settings.motion.shift_mm.x() = NAN;
  EXPECT_THROW(scan(block(2.0, 2.0), settings), ConfigError);
}

TEST(PaperPhantom, HasTheLayersOfThePaperAlongTheNeedle) {
  const Phantom phantom = paper_phantom();
  const Grid& grid = phantom.labels.grid;
  ASSERT_EQ(phantom.image.grid.X_SI.matrix(), grid.X_SI.matrix());
  const AffineTransform X_IS = grid.X_SI.inverse();
  double length[4] = {0, 0, 0, 0};
  for (double t = -3.0; t < 10.0; t += 0.01) {
    const Eigen::Vector3i at = (X_IS * (phantom.p_SE + t * phantom.axis_S)).array().round().cast<int>();
    ASSERT_TRUE(grid.contains(at.x(), at.y(), at.z()));
    length[static_cast<int>(phantom.labels.at(at.x(), at.y(), at.z()))] += 0.01;
  }
  EXPECT_NEAR(length[0], 3.0, 0.25);
  EXPECT_NEAR(length[1], 2.0, 0.25);
  EXPECT_NEAR(length[2], 0.9, 0.25);
  EXPECT_NEAR(length[3], 7.1, 0.25);
  EXPECT_NEAR(phantom.axis_S.norm(), 1.0, 1e-9);
  EXPECT_EQ(phantom.image.voxels, paper_phantom().image.voxels);
  EXPECT_THROW(paper_phantom({.voxel = Millimetres(0.0)}), ConfigError);
}

}  // namespace
}  // namespace biopsy::sim
