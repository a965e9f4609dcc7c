// The share of a voxel that a void with a soft edge and an end takes up.
#pragma once

#include "planner/imaging/depth_check/needle_corridor.hpp"
#include "planner/imaging/depth_check/void_fit.hpp"

namespace biopsy::imaging {

// Fades over `soft` at its side and its end; `rounding` of the end: 0 flat, 1 half a sphere.
struct VoidShape {
  VoidLine line;
  double depth = 0.0, soft = 0.4, rounding = 0.5;
};

// Mean over the voxel's volume, 0 to 1.
double coverage(const Corridor& corridor, const CorridorVoxel& voxel, const VoidShape& shape);

}  // namespace biopsy::imaging
