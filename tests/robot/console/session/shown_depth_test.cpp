// The depth that people read, against means of made-up ticks.
#include "robot/console/shown_depth.hpp"

#include <gtest/gtest.h>

#include <random>

namespace biopsy::robot {
namespace {

Measurement measured(std::int32_t depth_um, std::int32_t depth_b_um) {
  Measurement m;
  m.depth_um = depth_um, m.depth_b_um = depth_b_um;
  m.laser_valid = m.laser_b_valid = true;
  return m;
}
Measurement measured(std::int32_t depth_um) {
  return measured(depth_um, depth_um);
}

TEST(ShownDepth, IsTheMeanOfWhatThereIs) {
  ShownDepth shown;
  EXPECT_EQ(shown.mean_um(), 0);
  shown.add(measured(1'000));
  EXPECT_EQ(shown.mean_um(), 1'000);
  shown.add(measured(2'000));
  EXPECT_EQ(shown.mean_um(), 1'500);
}

TEST(ShownDepth, ForgetsWhatIsOlderThanAHundredTicks) {
  ShownDepth shown;
  for (int n = 0; n < 250; ++n) shown.add(measured(9'000'000));
  for (int n = 0; n < 99; ++n) shown.add(measured(-3'000));
  EXPECT_GT(shown.mean_um(), 0);
  shown.add(measured(-3'000));
  EXPECT_EQ(shown.mean_um(), -3'000);
}

TEST(ShownDepth, IsWithin15MicrometresOfANeedleThatStandsStill) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(2'500.0, 30.0);  // the laser's, in um
  ShownDepth shown;
  for (int n = 0; n < 10'000; ++n) {
    shown.add(measured(static_cast<std::int32_t>(noise(random))));
    if (n > 100) {
      ASSERT_NEAR(shown.mean_um(), 2'500, 15) << n;
    }
  }
}

// A reading without a target may be any number; two that disagree are of two places.
TEST(ShownDepth, IsKnownWhereBothLasersHaveTheirTargetsAndAgree) {
  const auto blind = [](bool a, bool b) {
    Measurement m = measured(0);
    m.laser_valid = a, m.laser_b_valid = b;
    return m;
  };
  EXPECT_FALSE(ShownDepth().is_known()) << "nothing was measured yet";
  for (const Measurement& fault : {blind(false, true), blind(true, false), blind(false, false),
                                   measured(0, 301), measured(301, 0), measured(-40, 3'000)}) {
    ShownDepth shown;
    shown.add(measured(2'000));
    EXPECT_TRUE(shown.is_known());
    shown.add(fault);
    EXPECT_TRUE(shown.is_known()) << "one spike";
    for (int n = 0; n < 10; ++n) shown.add(fault);
    EXPECT_FALSE(shown.is_known());
    for (int n = 0; n < 1'000; ++n) shown.add(fault);
    EXPECT_FALSE(shown.is_known());
    for (int n = 0; n < 100; ++n) shown.add(measured(2'000));
    EXPECT_TRUE(shown.is_known());
    EXPECT_EQ(shown.mean_um(), 2'000);
  }
  ShownDepth apart;
  for (int n = 0; n < 1'000; ++n) apart.add(measured(5'000, 5'300));
  EXPECT_TRUE(apart.is_known()) << "0.3 mm are allowed";
  ShownDepth never;
  for (int n = 0; n < 2; ++n) never.add(blind(false, true));
  EXPECT_FALSE(never.is_known());
}

TEST(ShownDepth, TakesNoReadingWithoutATargetIntoItsMean) {
  ShownDepth shown;
  Measurement blind = measured(9'000'000);
  blind.laser_valid = false;
  shown.add(measured(1'000)), shown.add(blind), shown.add(measured(3'000));
  EXPECT_EQ(shown.mean_um(), 2'000);
}

}  // namespace
}  // namespace biopsy::robot
