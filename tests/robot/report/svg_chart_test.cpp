#include "robot/report/plot/svg_chart.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robot/report/procedure/html_sections.hpp"
#include "tests/robot/report/example_run.hpp"

namespace biopsy::report {
namespace {

std::vector<Vertex> wave(std::size_t count) {
  std::vector<Vertex> points;
  for (std::size_t k = 0; k < count; ++k)
    points.push_back({static_cast<double>(k), std::sin(static_cast<double>(k) * 0.01)});
  return points;
}

TEST(Decimation, KeepsASpikeOfOneSampleWhereverItIs) {
  for (const std::size_t at : {0UL, 1UL, 33'333UL, 49'999UL, 99'999UL}) {
    auto points = wave(100'000);
    points[at].y = 42.0;
    const auto kept = decimated(points, 0, 100'000, 1500);
    EXPECT_EQ(std::count_if(kept.begin(), kept.end(),
                            [&](const Vertex& v) { return v.y == 42.0 && v.x == points[at].x; }),
              1)
        << "spike at " << at;
  }
}

TEST(Decimation, KeepsAtMostFourPointsAColumnInOrderOfTime) {
  const auto kept = decimated(wave(100'000), 0, 100'000, 1500);
  EXPECT_LE(kept.size(), 4U * 1500U);
  EXPECT_GT(kept.size(), 1500U);
  EXPECT_TRUE(
      std::is_sorted(kept.begin(), kept.end(), [](const Vertex& a, const Vertex& b) { return a.x < b.x; }));
}

TEST(Decimation, LeavesFewPointsAlone) {
  const auto points = wave(300);
  EXPECT_EQ(decimated(points, 0, 300, 1500).size(), points.size());
  EXPECT_TRUE(decimated({}, 0, 1, 1500).empty());
}

TEST(Ticks, AreRoundInsideTheRangeAndEvenlySpaced) {
  for (const auto& [low, high] :
       {std::pair{-0.3, 3.9}, {0.0, 25.0}, {-8.4, 8.4}, {0.0, 1e-3}, {0.0, 4321.0}}) {
    const auto ticks = round_ticks(low, high, 5);
    ASSERT_GE(ticks.size(), 3U) << low << " to " << high;
    ASSERT_LE(ticks.size(), 11U);
    EXPECT_GE(ticks.front(), low - 1e-9);
    EXPECT_LE(ticks.back(), high + 1e-9);
    for (std::size_t i = 2; i < ticks.size(); ++i)
      EXPECT_NEAR(ticks[i] - ticks[i - 1], ticks[1] - ticks[0], 1e-9 * std::abs(high));
  }
}

TEST(RunFigure, NamesEveryAxisWithItsUnitAndEveryState) {
  const std::string svg = run_figure(example_run());
  for (const char* text :
       {"Depth (mm)", "Drive (kV)", "Time from the start of the run (s)", ">hold<", ">retract<", ">armed<",
        "envelope of the permit", ">plan<", "1 waypoint to 2.00 mm", "image 2"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
}

// A one-tick over-voltage among 25,000 ticks must be a line that leaves the rest of the drawing.
TEST(RunFigure, DrawsAnOverVoltageOfOneTick) {
  RunRecord calm = example_run(), spiked = example_run();
  for (RunRecord* record : {&calm, &spiked})
    for (Sample& sample : record->samples) sample.drive_kV = sample.monitor_kV = 0.0F;
  spiked.samples[12'345].drive_kV = 7.0F;
  const std::string before = run_figure(calm), after = run_figure(spiked);
  EXPECT_NE(before, after);
  EXPECT_GT(after.size(), before.size());
}

TEST(RunFigure, StaysSmallForALongRunAndIsEmptyWithoutSamples) {
  RunRecord record = example_run();
  const auto once = record.samples;
  while (record.samples.size() < 300'000) {
    const double later = record.samples.back().time_ms + 1;
    for (Sample sample : once) {
      sample.time_ms += later;
      record.samples.push_back(sample);
    }
  }
  EXPECT_LT(run_figure(record).size(), 1'000'000U);
  EXPECT_EQ(run_figure(example_refusal()), "");
}

TEST(RunFigure, MarksTripsInTheColourOfAlarmsAndACalmRunHasNone) {
  EXPECT_EQ(run_figure(example_run()).find("#b00020"), std::string::npos);
  const std::string svg = run_figure(example_stop());
  EXPECT_NE(svg.find("trip 2"), std::string::npos);
  EXPECT_NE(svg.find("#b00020"), std::string::npos);
}

}  // namespace
}  // namespace biopsy::report
