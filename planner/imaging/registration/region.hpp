// The part of a volume that matters for one needle, and its smooth versions.
#pragma once

#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

// A box along S's axes, LPS mm.
struct Box {
  Point low = Point::Zero(), high = Point::Zero();

  bool contains(const Point& p_S) const {
    return (p_S.array() >= low.array() && p_S.array() <= high.array()).all();
  }
  void include(const Point& p_S, double margin_mm) {
    low = low.cwiseMin(p_S - Point::Constant(margin_mm));
    high = high.cwiseMax(p_S + Point::Constant(margin_mm));
  }
  Point centre() const { return 0.5 * (low + high); }
};

// Smallest block of voxels that covers the box, where they exist; empty (size 0) when they do not meet. Keeps
// the identity, drops the file list.
Volume cropped(const Volume& volume, const Box& box);

// A grid of cells that are `side` voxels large, as many as touch the grid.
Grid grid_of_cells(const Grid& grid, const Eigen::Vector3i& side);

// Every n-th voxel along each axis, as far apart as `step_mm` allows: of a smooth volume that is all there
// is.
Volume thinned(const Volume& volume, double step_mm);

// Gaussian of the given standard deviation in mm along each voxel axis; borders repeat their last voxel.
Volume smoothed(Volume volume, double sigma_mm);

// What lies in the box, smoothed likewise, with pixels as large as the smoothing leaves detail: of fine
// images a small part. Empty where the box and the volume do not meet.
Volume smoothed_coarse(const Volume& volume, const Box& box, double sigma_mm);

// Means over a box of `half_mm` to all sides, by running sums: a wide one costs no more than a narrow one.
// Borders repeat their last voxel.
Volume box_averaged(Volume volume, double half_mm);

}  // namespace biopsy::imaging
