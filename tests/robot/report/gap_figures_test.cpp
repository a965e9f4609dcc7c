#include "robot/report/gap/gap_figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "robot/report/plot/svg_bars.hpp"
#include "robot/report/plot/svg_chart.hpp"
#include "tests/count_of.hpp"
#include "tests/robot/report/gap_example.hpp"

namespace biopsy::report {
namespace {

// The paths of lines, each with its number of points.
std::vector<std::size_t> line_points(const std::string& svg) {
  std::vector<std::size_t> points;
  const std::string start = "<path fill=\"none\" stroke-linejoin=\"round\" d=\"";
  for (std::size_t at = svg.find(start); at != std::string::npos; at = svg.find(start, at + 1)) {
    const std::size_t from = at + start.size();
    const std::string d = svg.substr(from, svg.find('"', from) - from);
    points.push_back(static_cast<std::size_t>(
        std::count_if(d.begin(), d.end(), [](char c) { return c == 'M' || c == 'L'; })));
  }
  return points;
}

TEST(GapFigures, WhereShowsTheRunWithTheLargestGapAndTheOverlayAHeldOutOne) {
  GapFinding finding = example_effect();
  for (double& value : finding.traces[1].before) value += 3.0;  // by far the worst, and a training run
  EXPECT_EQ(largest_gap_trace(finding)->run, "triangle-20g");
  EXPECT_EQ(overlay_trace(finding)->run, "ramp-100g");
  for (GapTrace& trace : finding.traces) trace.held_out = false;
  EXPECT_EQ(overlay_trace(finding)->run, "triangle-20g");
  EXPECT_EQ(largest_gap_trace(GapFinding{}), nullptr);
}

TEST(GapFigures, WhereShadesEveryRegimeOfTheRunAndNamesAxesWithUnits) {
  const std::string svg = where_figure(example_effect());
  EXPECT_EQ(count_of(svg, "class=\"shade\""), 3U);  // the fourth regime does not occur in this run
  EXPECT_EQ(line_points(svg).size(), 2U);           // input and residual
  for (const char* text :
       {"after a polarity reversal", "while rising", "while falling", "Input (kV)", "Residual (mm)"})
    EXPECT_EQ(count_of(svg, std::string(">") + text + "<"), 1U) << text;
  EXPECT_EQ(count_of(svg, "#f7cf7a"), 2U);  // the most telling regime alone: its legend and its stretches
  GapFinding force = example_effect();
  force.force_drive = true;
  EXPECT_EQ(count_of(where_figure(force), ">Force (N)<"), 1U);
  EXPECT_EQ(count_of(where_figure(force), ">after the motion turns around<"), 1U);
}

// A regime's shading must cover the time the regime holds: 4 periods of 10 s with 2 x 1.2 s each.
TEST(GapFigures, ShadedStretchesCoverTheTimeOfTheirRegime) {
  const GapFinding finding = example_effect();
  const GapTrace& trace = *largest_gap_trace(finding);
  ASSERT_EQ(trace.run, "ramp-50g");
  const std::string svg = where_figure(finding);
  const std::size_t at = svg.find("class=\"shade\" d=\"") + 17;  // the run begins with a reversal
  std::istringstream path(svg.substr(at, svg.find('"', at) - at));
  double shaded = 0, from = 0, y = 0, to = 0, height = 0, back = 0;
  std::size_t stretches = 0;
  for (std::string stretch; std::getline(path, stretch, 'z'); ++stretches) {
    ASSERT_EQ(std::sscanf(stretch.c_str(), "M%lf %lfH%lfv%lfH%lf", &from, &y, &to, &height, &back), 5);
    EXPECT_EQ(back, from);
    EXPECT_GT(height, 50);
    shaded += to - from;
  }
  EXPECT_EQ(stretches, 2U * 8U);          // in two panels
  const double plot = 1000 - 100 - 83.6;  // left margin, room for the names of the noise levels
  EXPECT_NEAR(shaded / 2 / plot, 9.6 / 40.0, 0.01);
}

TEST(GapFigures, OverlayHoldsThreeDisplacementsAndTwoResiduals) {
  GapFinding finding = example_effect();
  const std::string svg = overlay_figure(finding);
  EXPECT_EQ(line_points(svg).size(), 5U);
  for (const char* name :
       {"measured", "old model", "new model", "measured − old model", "measured − new model"})
    EXPECT_EQ(count_of(svg, std::string(">") + name + "<"), 1U) << name;
  EXPECT_EQ(count_of(svg, "held out (s)"), 1U);
  for (GapTrace& trace : finding.traces) trace.after.clear();
  EXPECT_EQ(line_points(overlay_figure(finding)).size(), 3U);
  EXPECT_EQ(line_points(overlay_figure(example_unexplained())).size(), 3U);  // the model stayed as it was
}

TEST(GapFigures, ThinLongLinesToFifteenHundredPoints) {
  GapFinding finding = example_effect();
  finding.traces.resize(1);
  GapTrace& trace = finding.traces[0];
  const GapTrace once = trace;
  for (int repeat = 1; repeat < 20; ++repeat)
    for (std::size_t i = 0; i < once.time.size(); ++i) {
      trace.time.push_back(once.time[i] + 40.1 * repeat);
      trace.input.push_back(once.input[i]);
      trace.measured.push_back(once.measured[i]);
      trace.before.push_back(once.before[i]);
      trace.after.push_back(once.after[i]);
      trace.regime.push_back(once.regime[i]);
    }
  for (const std::string& svg : {where_figure(finding), overlay_figure(finding)})
    for (const std::size_t points : line_points(svg)) {
      EXPECT_LE(points, 1504U);
      EXPECT_GT(points, 700U);
    }
}

TEST(GapFigures, ARunOfManyTurnsGetsACloserLookAndACalmOneDoesNot) {
  GapFinding finding = example_effect();
  EXPECT_EQ(where_closer_figure(finding), "");
  finding.traces.erase(finding.traces.begin());  // leaves the fast triangle, 40 turns
  finding.traces.pop_back();
  EXPECT_EQ(line_points(where_closer_figure(finding)).size(), 2U);
}

TEST(GapFigures, SharesHaveTwoBarsARegimeAndWriteTheTrueValues) {
  const std::string svg = shares_figure(example_parameter());
  EXPECT_EQ(count_of(svg, "class=\"bar-of-chart\""), 4U);
  for (const char* value : {">21 %<", ">48 %<", ">40 %<", ">41 %<"})
    EXPECT_EQ(count_of(svg, value), 1U) << value;
  EXPECT_EQ(shares_figure(GapFinding{}), "");
}

TEST(Bars, AreAsLongAsTheirValuesAndNeverLeaveThePlot) {
  BarChart chart;
  chart.unit = "%";
  chart.series = {{"share", "#005fa8"}};
  chart.rows = {{"half", {50}}, {"full", {100}}, {"beyond", {250}}, {"below", {-20}}};
  const std::string svg = render(chart);
  std::vector<double> widths;
  for (std::size_t at = svg.find("bar-of-chart"); at != std::string::npos;
       at = svg.find("bar-of-chart", at + 1))
    widths.push_back(std::stod(svg.substr(svg.find("width=\"", at) + 7)));
  ASSERT_EQ(widths.size(), 4U);
  EXPECT_NEAR(widths[0], widths[1] / 2, 0.1);
  EXPECT_EQ(widths[2], widths[1]);
  EXPECT_EQ(widths[3], 0);
  EXPECT_EQ(count_of(svg, ">250 %<"), 1U);
}

TEST(GapFigures, ShapeDrawsMeanAndCountAgainstItsQuantity) {
  const ResidualShape shape = example_unexplained().shapes[0];
  const std::string svg = shape_figure(shape);
  EXPECT_EQ(line_points(svg), (std::vector<std::size_t>{40, 40}));
  EXPECT_EQ(count_of(svg, ">position (mm)<"), 1U);
  EXPECT_EQ(shape_figure({}), "");
}

}  // namespace
}  // namespace biopsy::report
