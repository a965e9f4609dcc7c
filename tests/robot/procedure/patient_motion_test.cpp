// How far a patient moved, and what follows. Motions are rigid ones written here, about points far from the
// path as well: the formula under test works about the entry.
#include "robot/procedure/images/patient_motion.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "robot/procedure/rehearsal.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

constexpr double kScore = 0.9, kScoreMin = 0.5;

DepthCheck matched(const Eigen::Vector3d& shift_mm, const Eigen::Vector3d& rotation_deg) {
  DepthCheck check;
  check.verdict = DepthVerdict::Accept;
  check.reason = "Tip found.";
  for (int a = 0; a < 3; ++a) check.shift_mm[a] = shift_mm[a], check.rotation_deg[a] = rotation_deg[a];
  check.registration_score = kScore;
  return check;
}

TEST(PatientMotion, IsTheLargerOfEntryAndTipOfARotationAboutAnyPoint) {
  verifies("R-33");
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const auto vector = [&](double size) {
    return Eigen::Vector3d(size * Eigen::Vector3d(normal(random), normal(random), normal(random)));
  };
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d entry = vector(50), axis = vector(1).normalized(), pivot = vector(200),
                          shift = vector(2);
    const Eigen::Vector3d turned_deg = vector(1);
    const Eigen::AngleAxisd turn(turned_deg.norm() * std::acos(-1.0) / 180.0, turned_deg.normalized());
    const Millimetres tip(8.0);
    const auto moved = [&](const Eigen::Vector3d& p) {
      return Eigen::Vector3d(turn * (p - pivot) + pivot + shift);
    };
    const Eigen::Vector3d at_tip = entry + tip.value * axis;
    const double truth = std::max((moved(entry) - entry).norm(), (moved(at_tip) - at_tip).norm());
    const DepthCheck check = matched(moved(entry) - entry, turned_deg);
    EXPECT_NEAR(*patient_motion_mm(check, axis, tip, kScoreMin), truth, 1e-9);
  }
}

TEST(PatientMotion, TakesAnAcceptBackAndNoOtherVerdict) {
  verifies("R-33", "R-42");
  const Direction axis = Direction::UnitZ();
  struct Row {
    double moved_mm;
    DepthVerdict verdict;
  };
  for (const Row& row : {Row{0.0, DepthVerdict::Accept},
                         {1.4, DepthVerdict::Accept},
                         {1.6, DepthVerdict::Unsure},
                         {1.9, DepthVerdict::Unsure},
                         {2.1, DepthVerdict::Reject},
                         {11.0, DepthVerdict::Reject}}) {
    DepthCheck check = matched({row.moved_mm, 0, 0}, {0, 0, 0});
    judge_patient_motion(check, axis, Millimetres(8.0), kScoreMin);
    EXPECT_EQ(check.verdict, row.verdict) << row.moved_mm;
    std::int32_t motion_um = 0;
    note_patient_motion(check, motion_um);
    EXPECT_EQ(motion_um, std::lround(1e3 * row.moved_mm));
    for (const DepthVerdict other : {DepthVerdict::Reject, DepthVerdict::Unsure}) {
      check = matched({row.moved_mm, 0, 0}, {0, 0, 0});
      check.verdict = other;
      judge_patient_motion(check, axis, Millimetres(8.0), kScoreMin);
      EXPECT_EQ(check.verdict, other);
      EXPECT_EQ(check.reason, "Tip found.");
    }
  }
}

TEST(PatientMotion, OfImagesThatDoNotMatchIsUnknown) {
  DepthCheck check = matched({9, 0, 0}, {0, 0, 0});
  check.registration_score = 0.4;
  judge_patient_motion(check, Direction::UnitZ(), Millimetres(8.0), kScoreMin);
  EXPECT_FALSE(check.patient_motion_mm);
  std::int32_t motion_um = 3'100;  // of the image before
  note_patient_motion(check, motion_um);
  EXPECT_EQ(motion_um, 3'100) << "a bad image is no proof that the patient moved back";
  check = matched({std::numeric_limits<double>::quiet_NaN(), 0, 0}, {0, 0, 0});
  EXPECT_FALSE(patient_motion_mm(check, Direction::UnitZ(), Millimetres(8.0), kScoreMin));
}

// The whole way, over the simulated scanner: the patient lies still for the plan and moves before the first
// image.
TEST(PatientMotion, OfMoreThanTwoMillimetresEndsTheRehearsalWithoutAnAcceptAndFeedsTheHazard) {
  verifies("R-33");
  int moved_far = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const ScratchFolder folder;
    Case given = read_case("liver");
    given.seed = seed;
    given.rehearsal.motion_mm = 6.0;
    const PreparedCase prepared = prepare(given, folder.path());
    const report::RunRecord run = rehearse(prepared, folder.path(), [](double, const std::string&) {}, {});
    for (const report::StepResult& step : run.steps) {
      if (!step.check || !step.check->patient_motion_mm) continue;
      if (*step.check->patient_motion_mm <= kPatientMotionMax_mm) continue;
      ++moved_far;
      EXPECT_NE(step.check->verdict, DepthVerdict::Accept) << seed;
      EXPECT_EQ(run.outcome, report::Outcome::Stopped) << seed;
    }
  }
  EXPECT_GE(moved_far, 2) << "nothing was tried";
}

}  // namespace
}  // namespace biopsy::robot
