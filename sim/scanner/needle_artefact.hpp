// How a needle looks on an MR image: a signal void, wider than the needle (blooming), that ends at its tip.
#pragma once

#include "robot/common/frames.hpp"
#include "robot/common/units.hpp"

namespace biopsy::sim {

// The needle is held by the robot: entry and axis are fixed in the scanner frame S and do not follow the
// patient. On its centreline half of the signal is gone at exactly `tip_depth`, whatever the other numbers
// are.
struct NeedleArtefact {
  Point p_SE = Point::Zero();
  Direction axis_S = Direction::UnitZ();  // insertion
  Millimetres tip_depth;                  // along the axis from the entry
  Millimetres radius{0.9};  // of the void at half signal: an 18 G needle is 0.64, blooming adds the rest
  Millimetres edge{0.25};   // the void fades over about this (one standard deviation)
  Millimetres shaft_behind{60.0};  // void this far behind the entry
  double tip_roundness = 0.5;      // 0: flat end, 1: half a sphere
  double tip_bloom = 0.2;          // the last `2 radius` before the tip swell by this fraction of the radius
  double loss = 0.97;              // signal lost in the core
};

// Fraction of the signal left at a point of the scanner frame, 0 to 1.
double signal_left(const NeedleArtefact& needle, const Point& p_S);

// A void that belongs to the tissue and moves with it: an old needle track, or a bubble where both ends
// coincide.
struct TissueVoid {
  Point p_SA = Point::Zero(), p_SB = Point::Zero();  // ends, before any motion
  Millimetres radius{1.0};
  Millimetres edge{0.3};
  double loss = 0.9;
};

double signal_left(const TissueVoid& trace, const Point& p_S);

}  // namespace biopsy::sim
