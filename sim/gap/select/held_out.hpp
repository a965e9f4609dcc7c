// What is held out: both parts must show the gap. What only one part shows is fitted without a test, or
// tested without having been fitted.
#pragma once

#include "sim/gap/fit/unknowns.hpp"

namespace biopsy::sim::gap {

// Every third run, beginning with the second; unless in one part a calibration of the training runs leaves
// next to nothing of what it leaves in the other, and another choice shows more in both. `start`: the given
// model with its calibration errors.
HeldOut choose_held_out(const Hypothesis& start, const Evidence& evidence);

}  // namespace biopsy::sim::gap
