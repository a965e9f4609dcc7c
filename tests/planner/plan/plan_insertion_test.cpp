#include "planner/plan/plan_insertion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "planner/plan/registration.hpp"
#include "planner/plan/seal.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::planner {
namespace {

// An oblique pose: nothing is parallel to a scanner axis.
RigidTransform oblique() {
  RigidTransform X_SR = RigidTransform::Identity();
  X_SR.linear() = Eigen::AngleAxisd(1.1, Point(1, -2, 0.5).normalized()).toRotationMatrix();
  X_SR.translation() = Point(-31, 48, 120);
  return X_SR;
}

// A sound request whose target is at p_RT in the robot's frame.
InsertionRequest request_for(const Point& p_RT) {
  InsertionRequest request;
  request.X_SR = oblique();
  request.target = {"P-7", "1.2.840.1", request.X_SR * Point(0, 0, 0), request.X_SR * p_RT};
  request.registration_fre_mm = 0.4;
  request.registration_tre_mm = 0.5;
  request.layers = {{"muscle", Millimetres(0), Millimetres(2)},
                    {"gap", Millimetres(2), Millimetres(2.9)},
                    {"liver", Millimetres(2.9), Millimetres(25)}};
  return request;
}

Plan plan_of(const InsertionRequest& request) {
  const auto result = plan_insertion(request);
  if (const auto* refusal = std::get_if<PlanRefusal>(&result)) {
    ADD_FAILURE() << refusal->what;
    return {};
  }
  return std::get<Plan>(result);
}

void expect_refusal(const InsertionRequest& request, const std::string& what, const std::string& remedy) {
  const auto result = plan_insertion(request);
  const auto* refusal = std::get_if<PlanRefusal>(&result);
  ASSERT_NE(refusal, nullptr) << "planned, though: " << what;
  EXPECT_NE(refusal->what.find(what), std::string::npos) << refusal->what;
  EXPECT_NE(refusal->remedy.find(remedy), std::string::npos) << refusal->remedy;
}

TEST(PlanInsertion, DepthAndOffsetAreMeasuredAlongAnObliqueNeedle) {
  const Plan plan = plan_of(request_for({0.3, -0.4, 3.5}));
  EXPECT_NEAR(plan.target_depth.value, 3.5, 1e-9);
  EXPECT_NEAR(plan.axis_offset.value, 0.5, 1e-9);
  EXPECT_NEAR(plan.limits.depth_max.value, 4.5, 1e-9);
  EXPECT_NEAR(plan.steps.back().depth.value, 3.5, 1e-9);
  EXPECT_EQ(plan.layer_at(plan.target_depth), "liver");
  EXPECT_EQ(plan.target.patient_id, "P-7");
  EXPECT_TRUE(plan.X_SR.isApprox(oblique()));
  EXPECT_TRUE(seal_holds(plan));
}

TEST(PlanInsertion, SameRequestSamePlan) {
  EXPECT_EQ(plan_of(request_for({0, 0, 3.5})).seal, plan_of(request_for({0, 0, 3.5})).seal);
}

TEST(PlanInsertion, LimitsStayWithinTheHardOnes) {
  for (double depth = 0.5; depth <= 11.0; depth += 0.5) {
    const Plan plan = plan_of(request_for({0, 0, depth - 1e-9 + (depth < 1 ? 2e-9 : 0)}));
    EXPECT_LE(to_um(plan.limits.depth_max), limits::kStroke_um);
    EXPECT_LE(to_mV(plan.limits.v_max), limits::kDriveMax_mV);
    for (const InsertionStep& stage : plan.steps) EXPECT_LE(stage.v_max, plan.limits.v_max);
    EXPECT_EQ(plan.limits.plausible.size(), 17u);
  }
}

TEST(PlanInsertion, RefusesATargetBesideTheAxisWithDistanceDirectionAndAngle) {
  InsertionRequest request = request_for({0, 0, 5});
  request.X_SR.linear().setIdentity();  // needle along +z: superior
  request.target.p_ST = request.target.p_SE + Point(3, -4, 5);
  expect_refusal(request, "5.0 mm off the needle axis (3.0 mm left, 4.0 mm anterior)",
                 "move the needle guide 3.0 mm left, 4.0 mm anterior, or re-aim it by 45.0 degrees");
}

TEST(PlanInsertion, OffsetIsTakenAcrossTheNeedleNotAcrossTheScanner) {
  plan_of(request_for({0.99, 0, 4}));
  plan_of(request_for({0, -0.99, 4}));
  expect_refusal(request_for({1.01, 0, 4}), "1.0 mm off the needle axis", "re-aim");
  expect_refusal(request_for({-0.8, 0.8, 4}), "1.1 mm off the needle axis", "re-aim");
}

TEST(PlanInsertion, RefusesATargetBehindTheTip) {
  expect_refusal(request_for({0, 0, -4.2}), "4.2 mm behind the needle tip", "turn the needle guide");
}

TEST(PlanInsertion, RefusesATargetBeyondTheStrokeSayingHowFarToAdvance) {
  expect_refusal(request_for({0, 0, 14.5}), "3.5 mm beyond the usable stroke of 11.0 mm",
                 "advance the needle guide by at least 3.5 mm");
  plan_of(request_for({0, 0, 10.99}));
  expect_refusal(request_for({0, 0, 11.01}), "beyond the usable stroke", "advance");
}

TEST(PlanInsertion, RefusesATargetTooNearToBeHeld) {
  expect_refusal(request_for({0, 0, 0.3}), "nearer than 0.5 mm", "withdraw the needle guide");
}

TEST(PlanInsertion, RefusesAnEntryAwayFromTheTip) {
  InsertionRequest request = request_for({0, 0, 4});
  request.target.p_SE += Point(0, 3, 0);
  expect_refusal(request, "3.0 mm from the entry chosen on the image (3.0 mm anterior)", "RAS");
}

TEST(PlanInsertion, FindsPointsInRasThatWereMeantAsLps) {
  verifies("R-61");
  InsertionRequest request = request_for({0, 0, 4});
  request.target.p_SE = ras_from_lps(request.target.p_SE);
  request.target.p_ST = ras_from_lps(request.target.p_ST);
  expect_refusal(request, "from the entry chosen on the image", "LPS");
}

TEST(PlanInsertion, RefusesARegistrationItCannotTrust) {
  InsertionRequest request = request_for({0, 0, 4});
  request.registration_fre_mm = 1.01;
  expect_refusal(request, "fiducial registration error 1.01 mm", "measure");
  request.registration_fre_mm = 0.4;
  request.registration_tre_mm = 1.2;
  expect_refusal(request, "at the target is 1.20 mm", "fiducials closer");
  request.registration_tre_mm = std::numeric_limits<double>::quiet_NaN();
  expect_refusal(request, "at the target", "fiducials");
  request = request_for({0, 0, 4});
  request.X_SR.linear() *= 1.01;
  expect_refusal(request, "not a rotation", "register");
  request.X_SR.linear() = Eigen::Vector3d(1, 1, -1).asDiagonal();
  expect_refusal(request, "not a rotation", "register");
}

TEST(PlanInsertion, RefusesPointsThatAreNotNumbers) {
  InsertionRequest request = request_for({0, 0, 4});
  request.target.p_ST.x() = std::numeric_limits<double>::quiet_NaN();
  expect_refusal(request, "not a number", "choose");
  request = request_for({0, 0, 4});
  request.target.p_SE.z() = std::numeric_limits<double>::infinity();
  expect_refusal(request, "not a number", "choose");
}

TEST(PlanInsertion, RefusesLayersThatDoNotReachTheTarget) {
  InsertionRequest request = request_for({0, 0, 4});
  request.layers.back().to = Millimetres(3.9);
  expect_refusal(request, "end at 3.90 mm, before the target at 4.00 mm", "extend");
  request.layers[1].from = Millimetres(2.1);
  expect_refusal(request, "layer 'gap' begins at 2.100 mm", "each beginning where");
  request.layers.clear();
  expect_refusal(request, "no tissue layer", "layers");
}

TEST(PlanInsertion, RefusesWaypointsThatDoNotRiseToTheTarget) {
  for (const std::vector<double>& depths :
       {std::vector<double>{3.0, 2.0}, {4.0}, {5.0}, {0.0}, {-1.0}, {2.0, 2.0}, {3.9}, {std::nan("")}}) {
    InsertionRequest request = request_for({0, 0, 4});
    for (const double depth : depths) request.waypoints.emplace_back(depth);
    expect_refusal(request, "does not lie between", "rising order");
  }
}

TEST(PlanInsertion, RefusesWhatTheStageCannotLift) {
  InsertionRequest request = request_for({0, 0, 10.9});
  request.weight = Grams(260);
  expect_refusal(request, "with 260 g the stage cannot hold 10.9 mm", "lighter weight");
  for (const double grams : {-1.0, 500.0, std::nan("")}) {
    request.weight = Grams(grams);
    expect_refusal(request, "is outside 0 to 300 g", "grams");
  }
}

TEST(PlanInsertion, TolerancesMayBeTightenedNotLoosened) {
  InsertionRequest request = request_for({0.5, 0, 4});
  request.tolerances.axis_offset = Millimetres(0.4);
  expect_refusal(request, "0.5 mm off the needle axis", "re-aim");
  request.tolerances.axis_offset = Millimetres(5);
  expect_refusal(request, "wider than the program allows", "at most 1.0 mm");
  request.tolerances = {};
  request.pace.crossing = MillimetresPerSecond(20);
  expect_refusal(request, "pace is out of range", "5 mm/s");
}

TEST(PlanInsertion, PlansAlongThePoseThatNeedlePoseAims) {
  InsertionRequest request = request_for({0, 0, 4});
  request.target.p_ST = request.target.p_SE + Point(-2, 3, 6);
  request.X_SR = needle_pose(request.target.p_SE, request.target.p_ST);
  const Plan plan = plan_of(request);
  EXPECT_NEAR(plan.target_depth.value, 7.0, 1e-9);
  EXPECT_NEAR(plan.axis_offset.value, 0.0, 1e-9);
}

}  // namespace
}  // namespace biopsy::planner
