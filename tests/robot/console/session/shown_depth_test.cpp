// The depth that people read, against means of made-up ticks.
#include "robot/console/shown_depth.hpp"

#include <gtest/gtest.h>

#include <random>

namespace biopsy::robot {
namespace {

TEST(ShownDepth, IsTheMeanOfWhatThereIs) {
  ShownDepth shown;
  EXPECT_EQ(shown.mean_um(), 0);
  shown.add(1'000);
  EXPECT_EQ(shown.mean_um(), 1'000);
  shown.add(2'000);
  EXPECT_EQ(shown.mean_um(), 1'500);
}

TEST(ShownDepth, ForgetsWhatIsOlderThanAHundredTicks) {
  ShownDepth shown;
  for (int n = 0; n < 250; ++n) shown.add(9'000'000);
  for (int n = 0; n < 99; ++n) shown.add(-3'000);
  EXPECT_GT(shown.mean_um(), 0);
  shown.add(-3'000);
  EXPECT_EQ(shown.mean_um(), -3'000);
}

TEST(ShownDepth, IsWithin15MicrometresOfANeedleThatStandsStill) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(2'500.0, 30.0);  // the laser's, in um
  ShownDepth shown;
  for (int n = 0; n < 10'000; ++n) {
    shown.add(static_cast<std::int32_t>(noise(random)));
    if (n > 100) {
      ASSERT_NEAR(shown.mean_um(), 2'500, 15) << n;
    }
  }
}

}  // namespace
}  // namespace biopsy::robot
