// Panels of closed-loop runs like the paper's: displacement against time, and the voltage.
#pragma once

#include <string>

#include "sim/paper/closed_loop.hpp"
#include "sim/paper/paper_figure.hpp"

namespace biopsy::sim::paper {

// Which part of a course to draw, s.
struct TimeSpan {
  double from = 0.0, to = 0.0;
};

// Thinned to about 1000 points.
FigureCurve drawn(std::string name, const Course& course, const std::vector<double>& values, TimeSpan part);

// Target (dashed) and plate A. mm
FigurePanel displacement_panel(std::string title, const Course& course, TimeSpan part);
// Amplitude of the square wave. kV
FigurePanel voltage_panel(std::string title, const Course& course, TimeSpan part);

// Sets y_low and y_high to the range of the curves, 0 included.
void fit_height(FigurePanel& panel);
// The same without 0.
void fit_closely(FigurePanel& panel);

}  // namespace biopsy::sim::paper
