// A plan as markups: its points come back through the reader; tests/robot/cli/slicer reads the file with
// another program's JSON.
#include "planner/plan/markups/plan_markups.hpp"

#include <gtest/gtest.h>

#include "planner/plan/markups/markups_file.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::planner {
namespace {

// A robot whose needle goes along +x of the scanner from 10, 20, 30.
Plan plan_along_x() {
  Plan plan;
  plan.target = {"P-7", "1.2.840.1", Point(10, 20, 30), Point(13.5, 20, 30)};
  plan.X_SR.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  plan.X_SR.translation() = Point(10, 20, 30);
  plan.steps = {
      {StepKind::Approach, Millimetres(1.25), {}, {}, Seconds(0), false, "stop short of \"gap\"\x1b"},
      {StepKind::Target, Millimetres(3.5), {}, {}, Seconds(1.0), true, "target in liver"}};
  return plan;
}

TEST(PlanMarkups, HoldEntryTargetAndTheEndOfEachStep) {
  verifies("R-61");
  const std::string text = plan_markups(plan_along_x());
  const auto points = parse_markups(text, "plan.mrk.json");
  ASSERT_EQ(points.size(), 4U);
  EXPECT_EQ(point_labelled(points, "entry", ""), Point(10, 20, 30));
  EXPECT_EQ(point_labelled(points, "target", ""), Point(13.5, 20, 30));
  EXPECT_EQ(point_labelled(points, "stage 1: 1.25 mm", ""), Point(11.25, 20, 30));
  EXPECT_EQ(point_labelled(points, "stage 2: 3.50 mm", ""), Point(13.5, 20, 30));
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
}

TEST(PlanMarkups, KeepsEveryDigit) {
  Plan plan = plan_along_x();
  plan.target.p_SE = Point(-1.0 / 3.0, 0.1, 1e-7);
  EXPECT_EQ(point_labelled(parse_markups(plan_markups(plan), "plan.json"), "entry", ""), plan.target.p_SE);
}

}  // namespace
}  // namespace biopsy::planner
