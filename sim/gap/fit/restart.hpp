// Fits of one effect from other shapes and places than the one that was reached, or from other strengths
// where that is all it has: the cost of an effect that acts at a place, that remembers, or that shifts a
// resonance has several minima.
#pragma once

#include "sim/gap/fit/unknowns.hpp"

namespace biopsy::sim::gap {

// The best of `fitted` and of such fits, by the training runs; everything but the effect is held meanwhile.
Hypothesis restarted(const Hypothesis& fitted, int effect, const Evidence& evidence);

}  // namespace biopsy::sim::gap
