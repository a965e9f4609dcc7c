#include "robot/report/plot/needle_overlay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "tests/robot/report/example_run.hpp"

namespace biopsy::report {
namespace {

struct Place {
  double x = NAN, y = NAN;
};

// The last place at which `shape` starts with "M x y" in this colour: rings and crosses are drawn from their
// left edge.
Place last_drawn(const std::string& svg, const std::string& colour, const std::string& shape) {
  const std::regex pattern("d=\"M(-?[0-9.]+) (-?[0-9.]+)" + shape + "[^\"]*\" fill=\"none\" stroke=\"" +
                           colour);
  Place place;
  for (auto match = std::sregex_iterator(svg.begin(), svg.end(), pattern); match != std::sregex_iterator();
       ++match)
    place = {std::stod((*match)[1]), std::stod((*match)[2])};
  return place;
}

Place entry(const std::string& svg) {
  const Place edge = last_drawn(svg, "#00e5ff", "a7");
  return {edge.x + 7, edge.y};
}

Place target(const std::string& svg) {
  const Place corner = last_drawn(svg, "#ff4dff", "l20");
  return {corner.x + 10, corner.y + 10};
}

// Units of the drawing in one millimetre, from its last scale bar and the text that says how long it is.
double units_per_mm(const std::string& svg) {
  const std::regex bar("v6h([0-9.]+)v-6"), text(">([0-9.]+) mm</text>");
  std::smatch length, millimetres;
  const std::string tail = svg.substr(svg.rfind("v6h"));
  EXPECT_TRUE(std::regex_search(tail, length, bar) && std::regex_search(tail, millimetres, text));
  return std::stod(length[1]) / std::stod(millimetres[1]);
}

TEST(PlanningOverlay, TargetLiesItsDepthFromTheEntryAlongTheAxisOnTheScaleOfTheBar) {
  const RunRecord record = example_run();
  for (const double angle : {0.0, 0.25, 1.4, -2.0}) {
    SliceGeometry geometry = *record.planning_geometry;
    geometry.axis_dx = std::sin(angle), geometry.axis_dy = std::cos(angle);
    const std::string svg = planning_overlay(record.planning_slice, geometry, *record.plan, {"plan", ""});
    const double expected = record.plan->target_depth.value * units_per_mm(svg);
    EXPECT_NEAR(target(svg).x - entry(svg).x, expected * geometry.axis_dx, 0.2);
    EXPECT_NEAR(target(svg).y - entry(svg).y, expected * geometry.axis_dy, 0.2);
  }
}

TEST(PlanningOverlay, NamesEntryTargetAndEveryBoundaryOnThePathWithItsDepth) {
  const RunRecord record = example_run();
  const std::string svg =
      planning_overlay(record.planning_slice, *record.planning_geometry, *record.plan, {"plan", "SIMULATED"});
  for (const char* text :
       {"entry 0.00 mm", "muscle | gap 2.00 mm", "gap | liver 2.90 mm", "target 3.50 mm", "SIMULATED"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
}

// Two labels a pixel apart would be unreadable: 0.01 mm layers must still have lines of their own.
TEST(PlanningOverlay, LabelsOfThinLayersNeverOverlap) {
  RunRecord record = example_run();
  record.plan->layers.clear();
  for (int i = 0; i < 8; ++i)
    record.plan->layers.push_back(
        {"layer " + std::to_string(i), Millimetres(2.0 + 0.01 * i), Millimetres(2.0 + 0.01 * (i + 1))});
  const std::string svg =
      planning_overlay(record.planning_slice, *record.planning_geometry, *record.plan, {"plan", ""});
  const std::regex label("<text x=\"[0-9.]+\" y=\"([0-9.]+)\"[^>]*>[a-z]");
  double previous = 0;
  int seen = 0;
  for (auto match = std::sregex_iterator(svg.begin(), svg.end(), label); match != std::sregex_iterator();
       ++match) {
    const double y = std::stod((*match)[1]);
    EXPECT_GE(y - previous, 15.0);
    EXPECT_LE(y, 430.0);
    previous = y;
    ++seen;
  }
  EXPECT_EQ(seen, 9);  // entry, seven boundaries, target
}

TEST(TipOverlay, DotLiesAtTheDepthFoundAndIsAbsentWithoutATip) {
  const StepResult stage = example_run().steps[1];
  DepthCheck check = *stage.check;
  check.depth = Millimetres(2.5);
  const TipDepths depths{stage.step.depth, stage.step.depth, &check};
  const std::string svg = tip_overlay(stage.after, *stage.geometry, depths, {"after", ""});
  std::smatch dot;
  ASSERT_TRUE(std::regex_search(svg, dot, std::regex("<circle cx=\"([0-9.]+)\" cy=\"([0-9.]+)\"")));
  const double along = std::hypot(std::stod(dot[1]) - entry(svg).x, std::stod(dot[2]) - entry(svg).y);
  EXPECT_NEAR(along, 2.5 * units_per_mm(svg), 0.2);
  check.tip_found = false;
  EXPECT_EQ(tip_overlay(stage.after, *stage.geometry, depths, {"after", ""}).find("<circle"),
            std::string::npos);
}

}  // namespace
}  // namespace biopsy::report
