// A needle of known tip painted into a real scan by a model of this test alone: a soft cylinder of lost
// signal, averaged over each voxel. Shares no code with the simulated scanner.
#pragma once

#include "robot/msg/volume.hpp"

namespace biopsy::imaging::rescan {

struct PaintedNeedle {
  Point p_SE = Point::Zero();  // LPS mm
  Direction axis_S = Direction::UnitZ();
  double tip_mm = 20.0;     // along the axis from p_SE: where the metal ends
  double beyond_mm = 0.0;   // how far the void goes on ahead of the metal
  double radius_mm = 1.2;   // of the void at half signal
  double soft_mm = 0.3;     // one standard deviation of its edge
  double roundness = 0.5;   // of its end: 0 flat, 1 half a sphere
  double bulb = 0.0;        // a ball at its end, wider than the shaft by this fraction
  double pile_up = 0.0;     // signal moved to one side of the shaft, as a fraction of the tissue's
  double loss = 0.95;       // of the signal within
  double behind_mm = 60.0;  // the shaft begins this far behind p_SE
};

// `floor`: mean of the noise where no signal is left, image units.
Volume painted(const Volume& scan, const PaintedNeedle& needle, double floor);

}  // namespace biopsy::imaging::rescan
