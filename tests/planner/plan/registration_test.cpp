#include "planner/plan/registration.hpp"

#include <gtest/gtest.h>

#include <random>

#include "robot/common/config_error.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::planner {
namespace {

using Random = std::mt19937_64;

Point random_point(Random& random, double half_width_mm) {
  std::uniform_real_distribution<double> along(-half_width_mm, half_width_mm);
  const double x = along(random), y = along(random), z = along(random);
  return {x, y, z};
}

Point noise(Random& random, double sigma_mm) {
  std::normal_distribution<double> error(0.0, sigma_mm);
  const double x = error(random), y = error(random), z = error(random);
  return {x, y, z};
}

RigidTransform random_pose(Random& random) {
  RigidTransform X = RigidTransform::Identity();
  X.linear() = Eigen::AngleAxisd(std::uniform_real_distribution<double>(0.0, 3.1)(random),
                                 random_point(random, 1.0).normalized())
                   .toRotationMatrix();
  X.translation() = random_point(random, 200.0);
  return X;
}

std::vector<FiducialPair> pairs_of(const std::vector<Point>& robot, const RigidTransform& X_SR) {
  std::vector<FiducialPair> pairs;
  for (const Point& p_RF : robot)
    pairs.push_back({"F" + std::to_string(pairs.size() + 1), p_RF, X_SR * p_RF});
  return pairs;
}

const std::vector<Point> kFrame = {{-40, -30, 0}, {45, -25, 10}, {-35, 40, 20},
                                   {30, 35, -15}, {0, 5, 60},    {10, -50, 30}};

PlanRefusal refusal_of(const std::vector<FiducialPair>& pairs) {
  const auto result = register_robot(pairs);
  EXPECT_TRUE(std::holds_alternative<PlanRefusal>(result));
  return std::holds_alternative<PlanRefusal>(result) ? std::get<PlanRefusal>(result) : PlanRefusal{};
}

TEST(Registration, RecoversAnyPoseFromPerfectPairs) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const RigidTransform truth = random_pose(random);
    std::vector<Point> frame = kFrame;
    if (trial % 2 == 1) frame.resize(3);  // three points lie in a plane: a reflection would fit as well
    const auto result = register_robot(pairs_of(frame, truth));
    ASSERT_TRUE(std::holds_alternative<Registration>(result));
    const auto& registration = std::get<Registration>(result);
    EXPECT_TRUE(registration.X_SR.isApprox(truth, 1e-9));
    EXPECT_NEAR(registration.X_SR.linear().determinant(), 1.0, 1e-12);
    EXPECT_LT(registration.fre_mm, 1e-9);
  }
}

TEST(Registration, NoOtherSmallMoveFitsBetter) {
  Random random(2);
  std::vector<FiducialPair> pairs = pairs_of(kFrame, random_pose(random));
  for (FiducialPair& pair : pairs) pair.p_SF += noise(random, 0.3);
  const auto best = std::get<Registration>(register_robot(pairs));
  for (int trial = 0; trial < 500; ++trial) {
    RigidTransform moved = best.X_SR;
    moved.translation() += noise(random, 0.05);
    moved.rotate(Eigen::AngleAxisd(1e-3, random_point(random, 1.0).normalized()));
    double sum = 0.0;
    for (const FiducialPair& pair : pairs) sum += (moved * pair.p_RF - pair.p_SF).squaredNorm();
    EXPECT_GT(std::sqrt(sum / static_cast<double>(pairs.size())), best.fre_mm);
  }
}

// The formula predicts the error at the target from the residual at the fiducials; the truth is known here.
TEST(Registration, PredictedTargetErrorAgreesWithMonteCarloWithin15Percent) {
  Random random(3);
  for (const std::size_t count : {std::size_t{4}, std::size_t{6}}) {
    const std::vector<Point> frame(kFrame.begin(), kFrame.begin() + static_cast<std::ptrdiff_t>(count));
    for (const Point& p_RT : {Point(0, 0, 10), Point(0, 0, 120), Point(90, -20, 40)}) {
      double predicted = 0.0, actual = 0.0;
      for (int trial = 0; trial < 3000; ++trial) {
        const RigidTransform truth = random_pose(random);
        std::vector<FiducialPair> pairs = pairs_of(frame, truth);
        for (FiducialPair& pair : pairs) pair.p_SF += noise(random, 0.15);
        const auto registration = std::get<Registration>(register_robot(pairs));
        actual += (registration.X_SR * p_RT - truth * p_RT).squaredNorm();
        predicted += std::pow(expected_tre_mm(registration, truth * p_RT), 2);
      }
      EXPECT_NEAR(std::sqrt(predicted / actual), 1.0, 0.15)
          << count << " fiducials, target " << p_RT.transpose();
    }
  }
}

TEST(Registration, RefusesTwoPairs) {
  EXPECT_NE(refusal_of(pairs_of({{0, 0, 0}, {50, 0, 0}}, RigidTransform::Identity())).what.find("at least 3"),
            std::string::npos);
}

TEST(Registration, RefusesFiducialsOnALineAndOnOneSpot) {
  const RigidTransform X_SR = RigidTransform::Identity();
  EXPECT_NE(
      refusal_of(pairs_of({{0, 0, 0}, {50, 1, 0}, {100, -1, 0}, {150, 0, 1}}, X_SR)).what.find("one line"),
      std::string::npos);
  std::vector<FiducialPair> pairs = pairs_of(kFrame, X_SR);
  for (FiducialPair& pair : pairs) pair.p_RF.y() = pair.p_RF.z() = 0.0;
  EXPECT_NE(refusal_of(pairs).what.find("in the robot frame"), std::string::npos);
  EXPECT_NE(refusal_of(pairs_of({{0, 0, 0}, {0.04, 0, 0}, {0, 0.05, 0}}, X_SR)).remedy.find("metres"),
            std::string::npos);
}

TEST(Registration, RefusesMirroredFiducialsInsteadOfReflectingTheRobot) {
  verifies("R-61");
  std::vector<FiducialPair> pairs = pairs_of(kFrame, RigidTransform::Identity());
  for (FiducialPair& pair : pairs) pair.p_SF.x() *= -1.0;
  EXPECT_NE(refusal_of(pairs).what.find("above the limit"), std::string::npos);
}

TEST(Registration, RefusesAnErrorAboveTheLimitNamingTheWorstFiducial) {
  std::vector<FiducialPair> pairs = pairs_of(kFrame, RigidTransform::Identity());
  pairs[3].p_SF += Point(6, 0, 0);
  EXPECT_NE(refusal_of(pairs).remedy.find("F4"), std::string::npos);
}

TEST(Registration, RefusesNotANumber) {
  std::vector<FiducialPair> pairs = pairs_of(kFrame, RigidTransform::Identity());
  pairs[1].p_RF.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal_of(pairs).what.find("not a number"), std::string::npos);
}

TEST(GivenTransform, IsReadRowByRowAndTurnedFromRasToLps) {
  // Robot z points to the patient's anterior, robot x to the right, robot y to the inferior.
  const RigidTransform X_SR =
      rigid_transform_from_ras({1, 0, 0, 10, 0, 0, 1, 20, 0, -1, 0, 30, 0, 0, 0, 1}, "case.toml");
  EXPECT_TRUE((X_SR * Point(0, 0, 0)).isApprox(Point(-10, -20, 30)));       // LPS: R becomes -L, A becomes -P
  EXPECT_TRUE((X_SR.linear() * Point(0, 0, 1)).isApprox(Point(0, -1, 0)));  // anterior is -P
}

TEST(GivenTransform, RefusesWhatIsNotRigid) {
  using Rows = std::array<double, 16>;
  const std::vector<std::pair<Rows, std::string>> cases = {
      {{1.01, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "stretches"},
      {{1, 0.1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "shears"},
      {{-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "mirrors"},
      {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}, "last row"},
      {{1, 0, 0, std::nan(""), 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "not a number"}};
  for (const auto& [rows, reason] : cases) {
    try {
      rigid_transform_from_ras(rows, "case.toml");
      ADD_FAILURE() << reason;
    } catch (const ConfigError& error) {
      EXPECT_NE(error.what_is_wrong.find(reason), std::string::npos) << error.what_is_wrong;
      EXPECT_EQ(error.where, "case.toml");
    }
  }
}

TEST(NeedlePose, WaitsAtTheEntryAndPointsAtTheTarget) {
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const Point p_SE = random_point(random, 100), p_ST = random_point(random, 100);
    const RigidTransform X_SR = needle_pose(p_SE, p_ST);
    EXPECT_TRUE((X_SR * Point(0, 0, (p_ST - p_SE).norm())).isApprox(p_ST, 1e-9));
    EXPECT_NEAR(X_SR.linear().determinant(), 1.0, 1e-9);
  }
  EXPECT_NO_THROW(needle_pose({0, 0, 5}, {0, 0, 1}));  // straight against robot z
  EXPECT_THROW(needle_pose({1, 2, 3}, {1, 2, 3}), ConfigError);
}

}  // namespace
}  // namespace biopsy::planner
