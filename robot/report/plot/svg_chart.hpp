// Panels and a state diagram over one shared x axis, as an SVG that prints well and needs no script.
#pragma once

#include <string>
#include <vector>

#include "robot/report/plot/svg_writer.hpp"

namespace biopsy::report {

struct Stroke {
  std::string colour = "#22303c";
  double width = 1.4;
  std::string dash;  // SVG dash pattern; empty: solid
};

// A line with an empty name is not in the legend.
struct ChartLine {
  std::string name;
  Stroke stroke;
  std::vector<Vertex> points;  // x never falls
};

// A horizontal line at y with its name in the right margin.
struct ChartLevel {
  double y = 0;
  std::string name;
};

// A measured value with an error bar of +- error.
struct ChartDot {
  double x = 0, y = 0, error = 0;
};

struct ChartPanel {
  std::string y_title;  // with its unit
  double height_px = 200;
  double y_low = 0, y_high = 1;
  std::vector<ChartLine> lines = {};
  std::vector<ChartLevel> levels = {};
  std::vector<ChartDot> dots = {};
  std::string dots_name = {};  // legend entry of the dots
};

struct ChartSpan {
  double x_from = 0, x_to = 0;
};

// One line of the state diagram: the times at which this state held.
struct ChartState {
  std::string name;
  bool alarm = false;
  std::vector<ChartSpan> spans;
};

// A shaded stretch through all panels, named above them.
struct ChartBand {
  ChartSpan span;
  std::string name, short_name;  // the short one where there is no room
};

// Stretches of one kind, shaded in one colour through all panels and named once, in a legend on top.
struct ChartShade {
  std::string name, colour;
  std::vector<ChartSpan> spans;
};

// A vertical line through all panels, named above them.
struct ChartMarker {
  double x = 0;
  std::string name;
  bool alarm = false;
};

struct Chart {
  std::string title, description;  // for screen readers
  std::string note;                // printed in the top right corner
  std::string x_title;
  double x_low = 0, x_high = 1;
  std::vector<ChartPanel> panels;
  std::string states_title;
  std::vector<ChartState> states;
  std::vector<ChartShade> shades;
  std::vector<ChartBand> bands;
  std::vector<ChartMarker> markers;
};

std::string render(const Chart& chart);

// chart_points.cpp. At most four points a column: first, lowest, highest, last; so a spike of one sample is
// kept.
std::vector<Vertex> decimated(const std::vector<Vertex>& points, double x_low, double x_high, int columns);

// Lines with their y range, widened by 6 %; what is not finite does not count.
ChartPanel autoscaled_panel(std::string y_title, double height_px, std::vector<ChartLine> lines);

// Round numbers (1, 2 or 5 times a power of ten) from low to high, about `count` of them.
std::vector<double> round_ticks(double low, double high, int count);

}  // namespace biopsy::report
