#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "planner/imaging/io/read_volume.hpp"
#include "planner/imaging/registration/local_contrast.hpp"
#include "planner/imaging/registration/register_rigid.hpp"
#include "tests/planner/imaging/analytic_scene.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::imaging {
namespace {

struct Motion {
  Eigen::Vector3d shift_mm, rotation_deg;
};

RigidTransform transform(const Motion& motion, const Point& about) {
  const Eigen::Vector3d turn = motion.rotation_deg * std::numbers::pi / 180.0;
  RigidTransform X = RigidTransform::Identity();
  if (turn.norm() > 0.0) X.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  X.translation() = about + motion.shift_mm - X.linear() * about;
  return X;
}

// Largest distance between where the true and the found motion put a point within 20 mm of the centre.
double worst_error_mm(const RigidTransform& truth, const RigidTransform& found) {
  double worst = 0.0;
  for (double x : {-20.0, 20.0})
    for (double y : {-20.0, 20.0})
      for (double z : {-20.0, 20.0})
        worst = std::max(worst, (truth * Point(x, y, z) - found * Point(x, y, z)).norm());
  return worst;
}

const Point kAbout(3.0, -4.0, 2.0);

RegistrationSettings settings() {
  RegistrationSettings s;
  s.box = {Point::Constant(-26.0), Point::Constant(26.0)};
  s.about = kAbout;
  return s;
}

class RegisterRigid : public testing::TestWithParam<Motion> {};

TEST_P(RegisterRigid, RecoversMotionDespiteDriftGrainAndAnotherGrid) {
  const RigidTransform truth = transform(GetParam(), kAbout), back = truth.inverse();
  const Volume before = scene::imaged(scene::grid(1.0, 3.0), [](const Point& p) { return scene::tissue(p); });
  const Volume after = scene::imaged(scene::grid(1.2, 3.6), [&](const Point& p) {
    return (1.3 + 0.004 * p.x()) * scene::tissue(back * p) + 40.0 + 20.0 * scene::grain(p);
  });
  const RegistrationResult result = register_rigid(before, after, settings());
  EXPECT_LT(worst_error_mm(truth, result.X_after_before), 0.3);
  EXPECT_LT((result.shift_mm - GetParam().shift_mm).norm(), 0.2);
  EXPECT_LT((result.rotation_deg - GetParam().rotation_deg).norm(), 0.4);
  EXPECT_GT(result.score, 0.9);
  EXPECT_TRUE(result.within_limits);
}

INSTANTIATE_TEST_SUITE_P(Motions, RegisterRigid,
                         testing::Values(Motion{{0, 0, 0}, {0, 0, 0}}, Motion{{3, -2.5, 3}, {2, -3, 3}},
                                         Motion{{-2, 4, 2}, {-4, 2, 2}}, Motion{{0, 0, -5}, {0, 5, 0}}));

TEST(RegisterRigid, IsNotPulledByAVoidUnderTheMask) {
  const Direction axis = Direction(1.0, 0.2, 0.1).normalized();
  const Volume before = scene::imaged(scene::grid(1.0, 3.0), [](const Point& p) { return scene::tissue(p); });
  const Volume after = scene::imaged(scene::grid(1.0, 3.0), [&](const Point& p) {
    return scene::tissue(p) * scene::left_by_needle(p, kAbout, axis, 20.0, 5.0);
  });
  RegistrationSettings masked = settings();
  masked.mask = NeedleMask{needle_frame(after.grid, kAbout, axis), -100.0, 100.0, 7.0};
  const RegistrationResult result = register_rigid(before, after, masked);
  EXPECT_LT(worst_error_mm(RigidTransform::Identity(), result.X_after_before), 0.05);
}

// A band that the scanner saturated in one image only has an edge that is no tissue's. What it still costs is
// within the reach of the local motion (3 mm, one standard deviation) that follows.
TEST(RegisterRigid, IsNotTurnedAwayByASaturationBand) {
  const Motion motion{{1.0, -2.0, 2.5}, {1, 0, -1}};
  const RigidTransform truth = transform(motion, kAbout), back = truth.inverse();
  const auto band = [](const Point& p) { return 0.35 + 0.65 / (1.0 + std::exp(-(p.y() + 10.0) / 3.0)); };
  const Volume before =
      scene::imaged(scene::grid(0.9, 2.5), [&](const Point& p) { return band(p) * scene::tissue(p); });
  const Volume after = scene::imaged(scene::grid(1.0, 3.6), [&](const Point& p) {
    return 0.8 * scene::tissue(back * p) + 15.0 * scene::grain(p);
  });
  const RegistrationResult result = register_rigid(before, after, settings());
  EXPECT_LT(worst_error_mm(truth, result.X_after_before), 3.0);
  EXPECT_TRUE(result.within_limits);
}

TEST(LocalContrast, IsTheSameInOtherUnitsAndWhateverLiesUnderTheMask) {
  const Direction axis = Direction(1.0, 0.2, 0.1).normalized();
  const Grid grid = scene::grid(1.0, 3.0);
  const NeedleMask mask{needle_frame(grid, kAbout, axis), -100.0, 100.0, 7.0};
  const Volume plain = scene::imaged(grid, [](const Point& p) { return scene::tissue(p); });
  const Volume changed = scene::imaged(
      grid, [&](const Point& p) { return 1.7 * scene::tissue(p) * (mask.covers(p) ? 0.1 : 1.0); });
  const Volume a = local_contrast(plain, mask), b = local_contrast(changed, mask);
  double left = 0.0, total = 0.0;
  for (std::size_t n = 0; n < a.voxels.size(); ++n) {
    const auto i = static_cast<int>(n) % grid.size.x(),
               j = static_cast<int>(n) / grid.size.x() % grid.size.y(),
               k = static_cast<int>(n) / (grid.size.x() * grid.size.y());
    if (mask.covers(grid.X_SI * Eigen::Vector3d(i, j, k))) continue;
    left += std::pow(static_cast<double>(a.voxels[n] - b.voxels[n]), 2);
    total += std::pow(static_cast<double>(a.voxels[n]), 2);
  }
  EXPECT_LT(std::sqrt(left / total), 0.02);
}

TEST(RegisterRigid, SaysSoWhenImagesHaveNothingInCommon) {
  const Volume before = scene::imaged(scene::grid(1.0, 3.0), [](const Point& p) { return scene::tissue(p); });
  const Volume after =
      scene::imaged(scene::grid(1.0, 3.0), [](const Point& p) { return 300.0 + 100.0 * scene::grain(p); });
  EXPECT_LT(register_rigid(before, after, settings()).score, 0.3);
  Volume far = before;
  far.grid.X_SI.translation() += Eigen::Vector3d(500.0, 0.0, 0.0);
  EXPECT_LE(register_rigid(far, before, settings()).score, 0.0);
}

TEST(RegisterRigid, FindsTheShiftBetweenARealPlanningAndGuidanceScan) {
  const auto folder = source_dir() / "../shared/data/images/mr";
  if (!std::filesystem::exists(folder / "prostate_guidance")) GTEST_SKIP() << "no real images at " << folder;
  const Volume planning = read_volume(folder / "prostate_planning"),
               guidance = read_volume(folder / "prostate_guidance");
  const Point centre(6, -27, 52), half(28, 24, 18);
  RegistrationSettings s;
  s.box = {centre - half, centre + half};
  s.about = centre;
  const RegistrationResult result = register_rigid(planning, guidance, s);
  EXPECT_LT((result.shift_mm - Eigen::Vector3d(1.0, -0.25, 2.75)).cwiseAbs().maxCoeff(), 1.5);
  EXPECT_LT(result.rotation_deg.norm(), 2.0);  // the given shift has none
  EXPECT_GT(result.score, 0.85);
}

}  // namespace
}  // namespace biopsy::imaging
