// Where a straight void may be: every line near the expected axis at once, from maps of what changed.
#pragma once

#include "planner/imaging/depth_check/void_line.hpp"

namespace biopsy::imaging {

struct SearchReach {
  double beside_mm = 8.0;  // at the entry
  double tilt_deg = 9.0;
  double depth_min_mm = -2.0, depth_max_mm = 120.0;
};

struct LineCandidate {
  VoidLine line;
  LineFit fit;
  // By how much the gain of this width is too large, for neighbouring voxels err alike: wide discs gather
  // what brightness and motion leave over, thin ones little but noise. 1 or more.
  double inflation = 1.0;

  double worth() const { return fit.gain / inflation; }
};

// The best line for each of several widths, the one of most worth first. The corridor is cut across into
// slabs; in each the change that a disc of lost signal would explain is mapped by a convolution
// (cv::filter2D); a line adds up what it meets in the maps, for all depths of its tip. Lines that lose as
// little as no needle does are taken only where there is no other.
std::vector<LineCandidate> line_candidates(const Corridor& corridor, const SearchReach& reach);

}  // namespace biopsy::imaging
