// How bright the tissue of one image is in another: coils, sequences and repetition times differ.
#pragma once

#include "planner/imaging/registration/register_rigid.hpp"

namespace biopsy::imaging {

// after = offset + slope . before, both varying slowly over the image.
struct BrightnessMap {
  Volume slope, offset;  // on a grid of cells that covers the after image's
};

// `before` lies on the after image's grid, NaN where it is unknown. Learned from tissue outside the needle's
// mask: a void must not count as a change of brightness.
BrightnessMap learn_brightness(const Volume& after, const Volume& before, const NeedleMask& needle);

}  // namespace biopsy::imaging
