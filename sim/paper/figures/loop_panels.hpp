// Closed-loop courses as pictures, drawn like the paper's: displacement against time, and the voltage below.
#pragma once

#include <string>

#include "sim/paper/closed_loop.hpp"
#include "sim/paper/paper_figure.hpp"

namespace biopsy::sim::paper {

// Which part of a course to draw, s.
struct TimeSpan {
  double from = 0.0, to = 0.0;
};

// A course in at most about 1000 points of a curve.
FigureCurve drawn(std::string name, const Course& course, const std::vector<double>& values, TimeSpan part);

// Target (dashed) and plate A. mm
FigurePanel displacement_panel(std::string title, const Course& course, TimeSpan part);
// Amplitude of the square wave. kV
FigurePanel voltage_panel(std::string title, const Course& course, TimeSpan part);

// Sets y_low and y_high to what the curves need.
void fit_height(FigurePanel& panel);
// The same without 0, where the curves stay far from it.
void fit_closely(FigurePanel& panel);

}  // namespace biopsy::sim::paper
