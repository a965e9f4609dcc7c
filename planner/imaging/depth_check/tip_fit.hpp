// Fits the end of a void to the voxels around it, each taken as the mean over its volume.
#pragma once

#include "planner/imaging/depth_check/void_line.hpp"

namespace biopsy::imaging {

struct TipFit {
  VoidLine line;  // deviation and width refined
  double loss = 0.0;
  double depth_mm = 0.0;  // where the centreline has lost half of what it loses
  double sigma_mm =
      0.0;  // of the depth: spread of its likelihood, widened by what the model leaves unexplained
  double low_mm = 0.0, high_mm = 0.0;  // depths that `chance` does not exclude
  double chi2 = 0.0, misfit = 1.0;     // misfit: reduced chi-square
};

// Starts from a tip known to about 2 mm. `chance`: evidence (standard deviations) that these two images show
// where nothing changed; what differs by less is no knowledge.
TipFit fit_tip(const Corridor& corridor, const VoidLine& line, double depth_mm, double chance);

}  // namespace biopsy::imaging
