// One panel of a figure as an SVG that prints well and needs no script: any x/y curves, also those that turn
// back (hysteresis), measured points, and a logarithmic x axis. All text is escaped; equal input gives equal
// bytes. What lies outside the panel's axes is clipped; a value that is not finite, or has no logarithm, is a
// gap in its curve.
#pragma once

#include <string>
#include <vector>

#include "sim/paper/paper_figure.hpp"

namespace biopsy::report {

// In SVG user units; the page scales the whole picture.
struct FigureSize {
  double width = 520, plot_height = 250;
};

std::string figure_svg(const FigurePanel& panel, const FigureSize& size = {});

// 1, 2, ..., 9 times powers of ten from low to high (both above 0); `named` are those that get a number.
struct LogarithmicTicks {
  std::vector<double> all, named;
};
LogarithmicTicks logarithmic_ticks(double low, double high);

}  // namespace biopsy::report
