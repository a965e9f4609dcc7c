// What tells a label map from a grey image that was cut to a few values: regions, not speckle.
#pragma once

#include <string>

#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

// Measured slice by slice, since slices may be thicker than what is labelled. Of real atlases and
// segmentations (2 to 680 labels) at most 2 % of the labelled voxels are alone and at most 31 % of the
// pieces; where more than 25 % of the pieces are, less than 23 % of the edges lead to the next value. Of real
// MR images cut to 5 to 30 values, 27 to 70 % of the pieces are single voxels and 39 to 97 % of the edges
// lead to the next value.
struct LabelPattern {
  std::size_t values = 0;   // different ones, 0 included
  double alike = 1.0;       // share of the pairs of neighbours, one of them labelled, with one value
  double alone = 0.0;       // share of the labelled voxels that none of their eight neighbours equals
  double single = 0.0;      // share of the pieces (connected, of one value) that are one voxel
  double next_value = 0.0;  // share of the pairs of different neighbours whose values follow each other
};

// Of whole numbers from 0, at most 2^24.
LabelPattern label_pattern(const Volume& volume);

// Why it looks like a grey image; empty: it does not. Of four values and fewer, which a threshold has too,
// only what is speckled: a thin shell has few neighbours alike, and no piece of one voxel.
std::string grey_pattern(const LabelPattern& pattern);

}  // namespace biopsy::imaging
