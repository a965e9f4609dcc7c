#include "robot/report/plot/figure_svg.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>

#include "tests/count_of.hpp"
#include "tests/robot/report/reproduction_example.hpp"

namespace biopsy::report {
namespace {

struct Point {
  double x, y;
};

// Subpaths of the n-th path without filling: the panel's curves, then the legend's samples.
std::vector<std::vector<Point>> subpaths(const std::string& svg, std::size_t n) {
  const std::regex path(R"re(<path fill="none" stroke-linejoin="round" d="([^"]*)")re"),
      vertex(R"(([ML])([-\d.]+) ([-\d.]+))");
  std::sregex_iterator found(svg.begin(), svg.end(), path);
  for (std::size_t i = 0; i < n && found != std::sregex_iterator(); ++i) ++found;
  std::vector<std::vector<Point>> parts;
  if (found == std::sregex_iterator()) return parts;
  const std::string d = (*found)[1];
  for (std::sregex_iterator v(d.begin(), d.end(), vertex), end; v != end; ++v) {
    if ((*v)[1] == "M") parts.emplace_back();
    parts.back().push_back({std::stod((*v)[2]), std::stod((*v)[3])});
  }
  return parts;
}

FigurePanel panel_of(std::vector<FigureCurve> curves) {
  return {"", "x", "y", 0.0, 10.0, 0.0, 1.0, false, std::move(curves)};
}

TEST(FigureSvg, ALoopComesBackAnotherWayThanItWent) {
  const auto parts = subpaths(figure_svg(example_loop()), 0);
  ASSERT_EQ(parts.size(), 1U);
  const std::vector<Point>& loop = parts.front();
  EXPECT_NEAR(loop.front().x, loop.back().x, 0.1);
  const auto far = std::max_element(loop.begin(), loop.end(), [](auto& a, auto& b) { return a.x < b.x; });
  EXPECT_GT(far - loop.begin(), 50);
  EXPECT_GT(loop.end() - far, 50);
  // Half way up and down: 3.75 kV gives 50/(1+e^0.75) = 16.0 % going up, 50/(1+e^-0.75) = 34.0 % coming back.
  const double middle = loop.front().x + (far->x - loop.front().x) * 3.75 / 8.0;
  const auto nearest = [&](auto from, auto to) {
    return *std::min_element(
        from, to, [&](auto& a, auto& b) { return std::abs(a.x - middle) < std::abs(b.x - middle); });
  };
  const double per_percent = 250.0 / 60.0;
  EXPECT_NEAR(nearest(loop.begin(), far).y - nearest(far, loop.end()).y, 18.0 * per_percent,
              2.0 * per_percent);
}

TEST(FigureSvg, LogarithmicAxisPutsEachDecadeEquallyFar) {
  FigurePanel panel = panel_of({{"", {0.1, 1.0, 10.0}, {0.5, 0.5, 0.5}, false, false}});
  panel.x_low = 0.1;
  panel.logarithmic_x = true;
  const auto parts = subpaths(figure_svg(panel), 0);
  ASSERT_EQ(parts.size(), 1U);
  ASSERT_EQ(parts[0].size(), 3U);
  EXPECT_NEAR(parts[0][1].x - parts[0][0].x, parts[0][2].x - parts[0][1].x, 0.11);
  EXPECT_GT(parts[0][1].x - parts[0][0].x, 100.0);
}

TEST(FigureSvg, LogarithmicTicksAreNinePerDecadeAndNamedAtRoundOnes) {
  const LogarithmicTicks two = logarithmic_ticks(0.1, 10.0);
  EXPECT_EQ(two.all.size(), 19U);
  ASSERT_EQ(two.named.size(), 7U);  // 0.1 0.2 0.5 1 2 5 10
  EXPECT_NEAR(two.named[1], 0.2, 1e-12);
  EXPECT_NEAR(two.named.back(), 10.0, 1e-12);
  EXPECT_EQ(logarithmic_ticks(1e-3, 1e3).named.size(), 7U);  // decades only
  EXPECT_TRUE(logarithmic_ticks(0.0, 10.0).all.empty());
  EXPECT_TRUE(logarithmic_ticks(10.0, 1.0).all.empty());
}

TEST(FigureSvg, WhatIsNotFiniteOrHasNoLogarithmIsAGap) {
  constexpr double missing = std::numeric_limits<double>::quiet_NaN();
  const std::string parted =
      figure_svg(panel_of({{"", {1, 2, 3, 4, 5}, {0.1, 0.2, missing, 0.2, 0.1}, false, false}}));
  ASSERT_EQ(count_of(parted, R"(stroke-linejoin="round")"), 2U);  // one path a piece
  EXPECT_EQ(subpaths(parted, 0).front().size(), 2U);
  EXPECT_EQ(subpaths(parted, 1).front().size(), 2U);
  FigurePanel panel = panel_of({{"", {0.0, 1.0, 10.0}, {0.5, 0.5, 0.5}, false, false}});
  panel.x_low = 1.0;
  panel.logarithmic_x = true;
  const std::string svg = figure_svg(panel);
  EXPECT_EQ(subpaths(svg, 0).front().size(), 2U);
  EXPECT_EQ(count_of(svg, "nan"), 0U);
  EXPECT_EQ(count_of(svg, "inf"), 0U);
}

TEST(FigureSvg, ALongRecordKeepsItsOneSpikeAndFewPoints) {
  FigureCurve curve;
  for (int i = 0; i < 200'000; ++i) {
    curve.x.push_back(i * 5e-5);
    curve.y.push_back(i == 77'777 ? 0.9 : 0.1);
  }
  const std::string svg = figure_svg(panel_of({curve}));
  const std::vector<Point> points = subpaths(svg, 0).front();
  EXPECT_LT(points.size(), 5000U);
  EXPECT_EQ(
      std::count_if(points.begin(), points.end(), [&](const Point& p) { return p.y < points[0].y - 150.0; }),
      1);
}

TEST(FigureSvg, MarksAreCirclesDashedIsDashedAndNamesStandInTheLegendEscaped) {
  const std::string svg = figure_svg(panel_of({{"measured <1>", {1, 2, 3}, {0.1, 0.2, 0.3}, false, true},
                                               {"target", {1, 3}, {0.5, 0.5}, true, false},
                                               {"", {1, 3}, {0.7, 0.7}, false, false}}));
  EXPECT_EQ(count_of(svg, "<circle"), 4U);           // three points and the legend
  EXPECT_EQ(count_of(svg, "stroke-dasharray"), 2U);  // the line and the legend
  EXPECT_EQ(count_of(svg, "measured &lt;1&gt;"), 1U);
  EXPECT_EQ(count_of(svg, "<script"), 0U);
}

TEST(FigureSvg, DrawsAnEmptyPanelAndOneWithoutExtentWithoutNaN) {
  for (const FigurePanel& panel :
       {FigurePanel{}, FigurePanel{"t", "x", "y", 1, 1, 2, 2, false, {{"a", {1}, {2}}}}}) {
    const std::string svg = figure_svg(panel);
    EXPECT_EQ(count_of(svg, "nan"), 0U);
    EXPECT_TRUE(svg.ends_with("</svg>"));
  }
}

}  // namespace
}  // namespace biopsy::report
