// What models without physics make of the same runs: a named effect has to be better than these.
#pragma once

#include <vector>

#include "sim/gap/gap_finding.hpp"
#include "sim/gap/select/evidence_runs.hpp"
#include "sim/plant/dataset.hpp"

namespace biopsy::sim::gap {

// Linear difference equations with an offset, driven by the input, and by the input and its square; fitted to
// the training runs by least squares, at the order and the rate that simulate these best, and simulated on
// the held-out rows. `evidence` says which rows these are; its noise is that of the readings.
std::vector<StrawMan> straw_men(const Dataset& dataset, const Evidence& evidence);

}  // namespace biopsy::sim::gap
