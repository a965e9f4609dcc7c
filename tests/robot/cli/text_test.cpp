// The small parts of what a command prints.
#include <gtest/gtest.h>

#include "robot/common/progress.hpp"
#include "robot/common/text/closest_names.hpp"
#include "robot/common/text/number_text.hpp"

namespace biopsy {
namespace {

TEST(EditDistance, CountsInsertionsDeletionsSubstitutionsAndSwaps) {
  EXPECT_EQ(edit_distance("", "needle"), 6U);
  EXPECT_EQ(edit_distance("needle", "needle"), 0U);
  EXPECT_EQ(edit_distance("nedle", "needle"), 1U);
  EXPECT_EQ(edit_distance("needles", "needle"), 1U);
  EXPECT_EQ(edit_distance("neeble", "needle"), 1U);
  EXPECT_EQ(edit_distance("enedle", "needle"), 1U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);  // the textbook's
}

TEST(ClosestNames, PutsTheClosestFirstAndLeavesTheRestOut) {
  const std::vector<std::string> names{"--series", "--seed", "--seconds", "--out"};
  EXPECT_EQ(closest_names("--sed", names).front(), "--seed");
  EXPECT_EQ(closest_names("-out", names), std::vector<std::string>{"--out"});
  EXPECT_EQ(closest_names("--onds", names), std::vector<std::string>{"--seconds"});
  EXPECT_TRUE(closest_names("--target", names).empty());
  EXPECT_TRUE(closest_names("", {"up", "gap"}).empty());
}

TEST(NumberText, CountsAndRoundsAsPeopleWrite) {
  EXPECT_EQ(counted(0, "row"), "0 rows");
  EXPECT_EQ(counted(1, "row"), "1 row");
  EXPECT_EQ(counted(2, "row"), "2 rows");
  EXPECT_EQ(fixed(-0.004, 2, "mm"), "0.00 mm");
  EXPECT_EQ(fixed(-0.006, 2, "mm"), "-0.01 mm");
}

TEST(TimeLeft, IsThatOfTheSamePace) {
  EXPECT_EQ(time_left_text(0.25, 10.0), "30 s left");
  EXPECT_EQ(time_left_text(0.1, 60.0), "9 min left");
  EXPECT_EQ(time_left_text(0.02, 600.0), "8.2 h left");
  EXPECT_EQ(time_left_text(0.5, 1.0), "") << "too early to say";
  EXPECT_EQ(time_left_text(-1.0, 60.0), "") << "nobody knows the share";
  EXPECT_EQ(time_left_text(0.001, 60.0), "");
}

}  // namespace
}  // namespace biopsy
