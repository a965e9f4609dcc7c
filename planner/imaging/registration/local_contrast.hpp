// An image without what varies slowly: a coil's field, a saturation band, an organ in another contrast. Their
// edges are no tissue's, and a registration would follow them.
#pragma once

#include <optional>

#include "planner/imaging/registration/needle_mask.hpp"

namespace biopsy::imaging {

// Deviation from the local mean, in local standard deviations. What lies under the mask is not asked: the
// void of a needle does not change its surroundings.
Volume local_contrast(const Volume& volume, const std::optional<NeedleMask>& mask);

}  // namespace biopsy::imaging
