// Rows of a figure's table: one place that decides what counts as reached.
#pragma once

#include <string>

#include "sim/paper/paper_figure.hpp"

namespace biopsy::sim::paper {

inline constexpr double kBand =
    0.2;  // the paper's figures are read off curves and differ from stage to stage

// What a row is about: "9a", "RMSE over settled windows", "mm".
struct RowName {
  std::string figure, quantity, unit;
};

PaperRow number_row(RowName name, double paper, double ours, std::string note, double band = kBand);
PaperRow at_most_row(RowName name, double paper, double ours, std::string note);

// A statement that holds where margin > 0. The margin is dimensionless: (what is seen)/(what is needed) - 1.
PaperRow trend_row(std::string figure, std::string statement, double margin, std::string note);

// Beyond the paper; `ours` against `before`, for a reader only.
PaperRow shown_row(RowName name, double before, double ours, std::string note);

// How far a row is from being reached: 0 inside its band, growing smoothly outside; what calibration lessens.
// Number: |ln(ours/paper)| beyond the band, in bands. Others: the shortfall as a share. Not finite: 10.
double shortfall(const PaperRow& row);

}  // namespace biopsy::sim::paper
