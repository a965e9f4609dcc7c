// Fits of one effect from other shapes and places than the one that was reached: the cost of an effect that
// acts at a place, or that remembers, has several minima.
#pragma once

#include "sim/gap/fit/unknowns.hpp"

namespace biopsy::sim::gap {

// The best of `fitted` and of such fits, by the training runs; everything but the effect is held meanwhile.
// Effects of which only the strength is unknown have one minimum and stay as they are.
Hypothesis restarted(const Hypothesis& fitted, int effect, const Evidence& evidence);

}  // namespace biopsy::sim::gap
