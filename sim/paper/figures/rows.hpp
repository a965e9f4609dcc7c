// Rows of a figure's table, and the criteria by which they are met.
#pragma once

#include <string>
#include <vector>

#include "sim/paper/figures/loop_scores.hpp"
#include "sim/paper/paper_figure.hpp"

namespace biopsy::sim::paper {

inline constexpr double kBand = 0.2;  // the paper's numbers are read off curves and differ between stages

// For example "9a", "RMSE over settled windows", "mm".
struct RowName {
  std::string figure, quantity, unit;
};

PaperRow number_row(RowName name, double paper, double ours, std::string note, double band = kBand);
PaperRow at_most_row(RowName name, double paper, double ours, std::string note);

// A statement that holds where margin > 0. margin = (value)/(required value) - 1.
PaperRow trend_row(std::string figure, std::string statement, double margin, std::string note);

// For information only: `ours` beside a reference value `before`.
PaperRow shown_row(RowName name, double before, double ours, std::string note);

// The settled RMSE of `course` for the other windows, as shown rows.
void add_window_rows(std::vector<PaperRow>& rows, const std::string& figure, const std::string& of,
                     double paper, const Course& course);

// How far a row is from being met: 0 inside its band, growing smoothly outside; the cost of calibration.
// Number: |ln(ours/paper)| beyond the band, in bands. Others: relative shortfall. Not finite: 10.
double shortfall(const PaperRow& row);

}  // namespace biopsy::sim::paper
