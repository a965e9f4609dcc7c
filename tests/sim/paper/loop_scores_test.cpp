// Scores of hand-written courses.
#include "sim/paper/figures/loop_scores.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace biopsy::sim::paper {
namespace {

Course written(double seconds, const OfTime& target, const OfTime& plate_a) {
  Course course;
  for (int k = 0; k < static_cast<int>(seconds * 1e3); ++k) {
    course.time.push_back(k * 1e-3);
    course.target.push_back(target(k * 1e-3));
    course.plate_a.push_back(plate_a(k * 1e-3));
  }
  return course;
}

// 2 mm until 5 s, then 6 mm; plate A closes the step with a time constant of 0.5 s.
Course first_order() {
  return written(
      20.0, [](double t) { return t < 5.0 ? 2.0 : 6.0; },
      [](double t) { return t < 5.0 ? 2.0 : 6.0 - 4.0 * std::exp(-(t - 5.0) / 0.5); });
}

TEST(LoopScores, AnEdgeCostsItsArithmeticOverEverythingAndNothingOnceSettled) {
  const Course course = first_order();
  EXPECT_NEAR(rmse(course), 4.0 * std::sqrt(0.5 / 2.0 / 20.0), 1e-3);
  // 16 exp(-4 t) from 2 s on, over the 3 s and 13 s that are settled.
  EXPECT_NEAR(rmse_settled(course), 4.0 * std::exp(-4.0) * std::sqrt(0.25 / 16.0), 1e-4);
}

TEST(LoopScores, AShorterWindowCountsMoreOfTheEdge) {
  const Course course = first_order();
  // 16 exp(-4 t) from 1.5 s on, over 3.5 s and 13.5 s; from 3 s on, over 2 s and 12 s.
  EXPECT_NEAR(rmse_settled(course, 1.5), 4.0 * std::exp(-3.0) * std::sqrt(0.25 / 17.0), 1e-3);
  EXPECT_NEAR(rmse_settled(course, 3.0), 4.0 * std::exp(-6.0) * std::sqrt(0.25 / 14.0), 1e-4);
}

// A square wave of 20 s whose falling edges take longer than rising ones by `later`, each along a straight
// line.
Course lagging(double later) {
  return written(40.0, square_target(2.0, 8.0, 0.05), [=](double t) {
    const double since = std::fmod(t, 20.0);
    const double rise = std::min(1.0, (since - 10.0) / 0.5), fall = std::min(1.0, since / (0.5 + later));
    if (since >= 10.0) return 2.0 + 6.0 * rise;
    return t < 10.0 ? 2.0 : 8.0 - 6.0 * fall;
  });
}

// 90 % of the way is judged, and 40 s in a panel: a line covers 0.2 s of them.
TEST(LoopScores, ALagIsSeenWhereItIsWiderThanALine) {
  EXPECT_LT(visible_lag(lagging(0.0)), 0.0);
  EXPECT_LT(visible_lag(lagging(0.2)), 0.0);
  EXPECT_GT(visible_lag(lagging(0.25)), 0.0);
  EXPECT_NEAR(visible_lag(lagging(0.5)), 0.9 * 0.5 / 0.2 - 1.0, 0.02);
}

TEST(LoopScores, NothingSettlesWhereTheTargetJumpsEverySecond) {
  const Course course = written(10.0, square_target(2.0, 8.0, 0.5), [](double) { return 0.0; });
  EXPECT_TRUE(std::isnan(rmse_settled(course)));
}

TEST(LoopScores, ASineIsSettledButForItsFirstMoment) {
  const Course course = written(20.0, sine_target(0.0, 8.0, 0.05), [](double) { return 0.0; });
  const std::vector<bool> chosen = settled(course);
  EXPECT_EQ(std::count(chosen.begin(), chosen.end(), true), 18000);
}

TEST(LoopScores, TravelTimeIsThatOfNinetyPercentOfTheWay) {
  const Course course = first_order();
  ASSERT_EQ(edges(course).size(), 1U);
  EXPECT_NEAR(travel_time(course, edges(course)[0]), 0.5 * std::log(10.0), 2e-3);
  EXPECT_LT(beyond_target(course, edges(course)[0]), 0.0);
}

TEST(LoopScores, OvershootCountsFromTheTargetAndOnlyUpwards) {
  const Course course = written(
      20.0, [](double t) { return t < 5.0    ? 2.0
                                  : t < 10.0 ? 8.0
                                             : 2.0; },
      [](double t) {
        return t < 5.0 ? 2.0 : t < 6.0 ? 8.8 : t < 10.0 ? 8.0 : 0.0;
      });
  EXPECT_NEAR(overshoot_percent(course), 10.0, 1e-9);
  ASSERT_EQ(edges(course).size(), 2U);
  EXPECT_NEAR(beyond_target(course, edges(course)[1]), 2.0, 1e-9);
}

TEST(LoopScores, TransferGivesBackGainAndLagOfASine) {
  const double turn = 2.0 * std::numbers::pi * 0.2;
  const Course course = written(
      20.0, [&](double t) { return 4.0 - 4.0 * std::cos(turn * t); },
      [&](double t) { return 4.1 - 3.2 * std::cos(turn * t - 0.3) + 0.2 * std::cos(3.0 * turn * t); });
  const Transfer seen = transfer(course, 0.2, 5.0);
  EXPECT_NEAR(seen.gain, 0.8, 1e-6);
  EXPECT_NEAR(seen.lag_degrees, 0.3 * 180.0 / std::numbers::pi, 1e-4);
}

}  // namespace
}  // namespace biopsy::sim::paper
