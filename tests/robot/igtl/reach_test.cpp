// The needle's axis against poses that were computed by hand.
#include "robot/igtl/reach.hpp"

#include <gtest/gtest.h>

#include <random>

namespace biopsy::igtl {
namespace {

// The robot looks towards posterior from (10, 50, -30) RAS: its z is -A, its x is R, its y is S...
// right-handed.
Transform from_anterior() {
  Transform pose;
  pose.columns = {1, 0, 0, 0, 0, 1, 0, -1, 0, 10, 50, -30};
  return pose;
}

RigidTransform pose_of(const Transform& transform) {
  const auto given = calibration_of(transform);
  EXPECT_TRUE(std::holds_alternative<RigidTransform>(given));
  return std::get<RigidTransform>(given);
}

Transform at(float r, float a, float s) {
  Transform target;
  target.columns[9] = r, target.columns[10] = a, target.columns[11] = s;
  return target;
}

TEST(IgtlReach, MeasuresAlongTheAxisOfTheCalibration) {
  const RigidTransform X_SR = pose_of(from_anterior());
  const auto found = reach(X_SR, at(10.6F, 46.0F, -30.8F));
  ASSERT_TRUE(std::holds_alternative<Reachable>(found)) << std::get<Refused>(found).why;
  EXPECT_NEAR(std::get<Reachable>(found).depth.value, 4.0, 1e-5);
  EXPECT_NEAR(std::get<Reachable>(found).axis_offset.value, 1.0, 1e-5);  // 0.6 and 0.8 mm aside
  EXPECT_NE(std::get<Refused>(reach(X_SR, at(10, 54, -30))).why.find("4.0 mm behind"), std::string::npos);
  EXPECT_NE(std::get<Refused>(reach(X_SR, at(13, 46, -34))).why.find("5.0 mm off"), std::string::npos);
}

TEST(IgtlReach, PutsTheTipOnTheAxisWithTheOrientationOfTheRobot) {
  const RigidTransform X_SR = pose_of(from_anterior());
  Transform expected = from_anterior();
  expected.columns[10] = 47.5F;
  const Transform tip = tip_at(X_SR, Millimetres(2.5));
  for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(tip.columns[i], expected.columns[i], 1e-5) << i;
}

TEST(IgtlReach, FindsTheDepthOfAnyTargetThatWasPutOnTheAxis) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> turn(-1.0, 1.0), depth(0.6, 10.9), place(-200.0, 200.0);
  for (int round = 0; round < 300; ++round) {
    RigidTransform X_SR = RigidTransform::Identity();
    X_SR.linear() = Eigen::Quaterniond(turn(random), turn(random), turn(random), turn(random))
                        .normalized()
                        .toRotationMatrix();
    X_SR.translation() = Point(place(random), place(random), place(random));
    const RigidTransform again = pose_of(tip_at(X_SR, Millimetres(0)));
    const Millimetres deep(depth(random));
    const auto found = reach(again, tip_at(X_SR, deep));
    ASSERT_TRUE(std::holds_alternative<Reachable>(found)) << std::get<Refused>(found).why;
    EXPECT_NEAR(std::get<Reachable>(found).depth.value, deep.value,
                1e-3);  // numbers go over the wire as floats
    EXPECT_LT(std::get<Reachable>(found).axis_offset.value, 1e-3);
  }
}

TEST(IgtlReach, RefusesACalibrationThatMirrors) {
  Transform mirrored;
  mirrored.columns[0] = -1.0F;
  const auto given = calibration_of(mirrored);
  ASSERT_TRUE(std::holds_alternative<Refused>(given));
  EXPECT_NE(std::get<Refused>(given).why.find("mirrors"), std::string::npos);
}

}  // namespace
}  // namespace biopsy::igtl
