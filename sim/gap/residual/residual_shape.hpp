// For what stays unexplained: which one quantity does the residual depend on, and with what curve?
#pragma once

#include <vector>

#include "sim/gap/gap_finding.hpp"
#include "sim/gap/select/evidence_runs.hpp"

namespace biopsy::sim::gap {

// Mean residual (mm) over some twenty bins of one quantity at a time: drive (signed and magnitude), speed,
// position, acceleration, time since reversal, time in run, weight. Best first; quantities that explain less
// than 1 % are left out, so that noise gives an empty list.
//
// share_explained is what a curve drawn from the other runs explains of a run it has not seen (other sixths
// of a single run). A correlated residual follows any curve by chance where the curve was drawn from it, but
// not elsewhere; copies shifted in time would not do as a measure of chance, because a periodic drive meets
// itself again. One run alone cannot tell time in run or weight from anything, so there they are left out.
//
// Position, speed and acceleration are the model's: the measured ones contain the residual, which would then
// be explained by itself. `residual`: measured - model of all rows of all runs, one after the other. m
std::vector<ResidualShape> residual_shapes(const Evidence& evidence, const PlantModel& model,
                                           const std::vector<double>& residual);

}  // namespace biopsy::sim::gap
