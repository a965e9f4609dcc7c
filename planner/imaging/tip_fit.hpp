// Fits the end of a void to the voxels around it, each taken as the mean over its volume.
#pragma once

#include "planner/imaging/void_line.hpp"

namespace biopsy::imaging {

struct TipFit {
  VoidLine line;           // deviation and width refined
  double loss = 0.0;
  double depth_mm = 0.0;   // where the centreline has lost half of what it loses
  double sigma_mm = 0.0;   // of the depth: spread of its likelihood, widened by what the model leaves unexplained
  double misfit = 1.0;     // reduced chi-square
};

// Starts from a tip known to about 2 mm.
TipFit fit_tip(const Corridor& corridor, const VoidLine& line, double depth_mm);

}  // namespace biopsy::imaging
