// Where else a needle could lie that is seen by the outermost slice of a stack alone, or by a single one.
#pragma once

#include <vector>

#include "planner/imaging/depth_check/void_line.hpp"

namespace biopsy::imaging {

// A line and where the void's end lies along it.
struct PlacedLine {
  VoidLine line;
  double depth_mm = 0.0;
};

// A slice tells how much of a needle lies within its thickness, not on which side of its middle: `seen`,
// reflected in the middle of each such slice that it lies along (within 15 degrees). Without those that are
// nearly the same as `seen`.
std::vector<PlacedLine> reflected_lines(const Corridor& corridor, const PlacedLine& seen);

}  // namespace biopsy::imaging
