// Finds where a new void along the needle's path ends.
#pragma once

#include "planner/imaging/depth_check/needle_corridor.hpp"

namespace biopsy::imaging {

struct TipSettings {
  double deviation_max_mm = 3.0;  // needles bend and brackets sag by a couple of millimetres
  double tilt_max_deg = 2.0;
  double depth_min_mm = -2.0, depth_max_mm = 120.0;
};

struct TipFinding {
  // Evidence: by how many standard deviations the best void along the path beats "nothing changed", and the
  // same for the best of the control paths beside it, where no needle can be. Their ratio is what counts:
  // whatever makes the images differ everywhere (motion, ghosts, another sequence) raises both.
  double evidence = 0.0, control_evidence = 0.0;
  double visible = 0.0;  // evidence that a plain 1 mm void losing half its signal over 10 mm would have given
  double loss = 0.0;     // fraction of the signal lost in the void
  double radius_mm = 0.0;
  double depth_mm = 0.0, sigma_mm = 0.0;  // tip, along the expected axis from the entry
  double low_mm = 0.0, high_mm = 0.0;     // depths nearby that the differences beside the path could imitate
  double across_mm = 0.0, up_mm = 0.0;    // where the void lies beside the expected axis, at its tip
  double tilt_deg = 0.0;
  double gap_mm = 0.0;  // longest stretch between entry and tip where the void is clearly missing
  double rival_depth_mm = 0.0,
         rival_against = 1e9;  // likeliest tip elsewhere (6 mm or more), and evidence against it
  double darkest = 1.0;        // predicted signal at the tip, darkest voxel over the median along the void
  bool at_end = false;         // the void goes on to where the images end
};

// Maximum likelihood over depth, deviation, tilt, width and loss of one straight void that begins behind the
// entry. Asks only what changed; any planned depth is unknown here. `corridor.voxels` must not be empty.
TipFinding find_tip(const Corridor& corridor, const TipSettings& settings);

}  // namespace biopsy::imaging
