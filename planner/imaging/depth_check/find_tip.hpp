// Finds where a new void along the needle's path ends, where it lies and how well that is known.
#pragma once

#include <vector>

#include "planner/imaging/depth_check/line_candidates.hpp"

namespace biopsy::imaging {

// A place beside the axis or a slope against it, with its covariance.
struct Planar {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  // From `value` to another that explains the images as well, on the other side of a slice. Zero: none.
  Eigen::Vector2d other = Eigen::Vector2d::Zero();

  Planar elsewhere() const { return {value + other, covariance, -other}; }
};

struct TipFinding {
  // Evidence: by how many standard deviations signal is lost in the best void, as measured beside it in the
  // same two images: whatever makes them differ everywhere (motion, ghosts, another sequence) lowers it.
  double evidence = 0.0;
  double visible = 0.0;  // evidence that a plain 1 mm void losing half its signal over 10 mm would have given
  double loss_sigma = 0.0;
  double loss = 0.0;  // fraction of the signal lost in the void
  double radius_mm = 0.0;
  double depth_mm = 0.0, sigma_mm = 0.0;   // end of the void, along the expected axis from the entry
  std::vector<double> depths_mm, weights;  // its likelihood at every depth; the weights add up to 1
  Planar beside_mm;                        // (across, up): where the void's end lies beside the expected axis
  Planar slope;                            // mm beside per mm along
  double gap_mm = 0.0;             // longest stretch between entry and tip where the void is clearly missing
  double seen_to_mm = 0.0;         // both images cover the path as far as this
  std::size_t control_places = 0;  // where the errors were measured
  bool at_end = false;             // the void goes on to where the images end
};

// Maximum likelihood over depth, deviation, tilt, width and loss of one straight void that begins behind the
// entry. Asks only what changed; any planned depth is unknown here. `corridor.voxels` must not be empty.
TipFinding find_tip(const Corridor& corridor, const SearchReach& reach);

}  // namespace biopsy::imaging
