// From the places of single slices to one voxel grid. Positions and orientations alone decide (DICOM PS3.3
// C.7.6.2.1.1): never the slice thickness, the stated spacing, the instance number or the order of the files.
#pragma once

#include <string>
#include <vector>

#include "planner/imaging/io/grid_rules.hpp"

namespace biopsy::imaging {

struct SlicePlane {
  std::string name;            // the file, with the frame where a file holds several
  Point p_SV = Point::Zero();  // centre of the first voxel, LPS mm (ImagePositionPatient)
  Direction along_row =
      Direction::UnitX();  // of rising column index i (first triplet of ImageOrientationPatient)
  Direction along_column = Direction::UnitY();  // of rising row index j (second triplet)
  double spacing_i_mm = 0.0;                    // between columns: the SECOND number of PixelSpacing
  double spacing_j_mm = 0.0;                    // between rows: the first number
  int columns = 0, rows = 0;
  double stated_gap_mm = 0.0;  // SpacingBetweenSlices, 0 where absent: only to warn
  double thickness_mm = 0.0;   // SliceThickness, 0 where absent: only to warn
};

struct SliceStack {
  Grid grid;                          // k rises along along_row x along_column: always right-handed
  std::vector<std::size_t> order;     // order[k]: index of the given slice that is slice k
  std::vector<std::string> warnings;  // a stated spacing or thickness that the positions contradict
};

// Neighbouring slices and the whole stack may be off a regular grid by this much: files round positions to
// 1e-5 mm, and half of the robot's 0.1 mm is the most an image may cost.
inline constexpr double kStackTolerance_mm = 0.05;

// Throws ConfigError naming the slices: other size, spacing or orientation within the stack, fewer than three
// slices, two at one place, a tilted stack (sheared, gantry tilt), uneven gaps (a missing slice).
SliceStack stack_slices(const std::vector<SlicePlane>& slices);

// The same for confirmation images, which are often a few slices in several planes: one stack for each
// orientation, from one slice on; `order` counts in `slices`. A single slice has the spacing or thickness
// that its header states; without any it is refused.
std::vector<SliceStack> stack_slabs(const std::vector<SlicePlane>& slices);

}  // namespace biopsy::imaging
