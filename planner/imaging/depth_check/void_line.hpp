// How well one straight void explains what changed in a corridor, for all depths of its tip at once.
#pragma once

#include <vector>

#include "planner/imaging/depth_check/needle_corridor.hpp"

namespace biopsy::imaging {

// No void loses more than everything; a little for errors of brightness.
inline constexpr double kLossMost = 1.1;

// A straight line beside the expected axis, and how wide the void on it is.
struct VoidLine {
  double u = 0.0, v = 0.0;              // at the entry, mm
  double u_slope = 0.0, v_slope = 0.0;  // mm per mm along
  double radius_mm = 1.0;
};

// Twice the log of the likelihood ratio against "nothing changed", maximised over the fraction of signal
// lost.
struct LineFit {
  double gain = 0.0;
  double loss = 0.0;
  double start_mm = 0.0, tip_mm = 0.0;
};

// Matched filter sums per bin along the line: the template is predicted signal times coverage of the voxel.
struct LineProfile {
  double t_min = 0.0, bin_mm = 0.0;
  std::vector<double> match, energy;  // sums of template * change / variance and template^2 / variance

  double at(std::size_t bin) const { return t_min + bin_mm * static_cast<double>(bin); }  // start of the bin
};

class LineSearch {
 public:
  LineSearch(const Corridor& corridor, double depth_min_mm, double depth_max_mm);

  LineProfile profile(const VoidLine& line) const;
  LineFit best_tip(const LineProfile& profile) const;
  // Best gain over starts for every possible tip: gain[n] is for a tip at profile.at(n).
  std::vector<double> gain_by_tip(const LineProfile& profile) const;

 private:
  struct CellRange {
    int first, last;
  };
  int cell_of(double beside_mm) const;
  std::size_t cell(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(cells_) +
           static_cast<std::size_t>(column);
  }
  CellRange cells_near(double at_entry, double slope, double reach_mm) const;

  const Corridor& corridor_;
  double depth_min_mm_, depth_max_mm_;
  int cells_ = 0;                                 // per side of a square about the axis
  std::vector<std::vector<std::uint32_t>> grid_;  // voxels by their place beside the axis
};

}  // namespace biopsy::imaging
