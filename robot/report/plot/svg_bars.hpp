// Horizontal bars, several to a row, with their values written at their ends: the companion of svg_chart.
#pragma once

#include <string>
#include <vector>

namespace biopsy::report {

struct BarSeries {
  std::string name, colour;
};

struct BarRow {
  std::string name;
  std::vector<double> values;  // one a series; not finite: written as unknown, drawn as nothing
};

struct BarChart {
  std::string title, description;  // for screen readers
  std::string x_title, unit;       // of all values
  double x_high = 100;             // bars end here; the value written is the true one
  std::vector<BarSeries> series;
  std::vector<BarRow> rows;
};

std::string render(const BarChart& chart);

}  // namespace biopsy::report
