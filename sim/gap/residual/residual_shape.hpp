// Dependence of an unexplained residual on single quantities.
#pragma once

#include <vector>

#include "sim/gap/gap_finding.hpp"
#include "sim/gap/select/evidence_runs.hpp"

namespace biopsy::sim::gap {

// Mean residual (mm) over some twenty bins of one quantity at a time: drive (signed and magnitude), speed,
// position, acceleration, time since reversal, time in run, weight. Best first; quantities that explain less
// than 1 % are left out, so that noise gives an empty list.
//
// share_explained is cross-validated: the curve of the other runs (other sixths of a single run) applied to a
// run. A correlated residual follows its own curve by chance, but not another run's; copies shifted in time
// cannot measure chance, because the drive is periodic. In a single run, time in run and weight cannot be
// separated from other quantities and are left out.
//
// Position, speed and acceleration are the model's: the measured ones contain the residual and would explain
// it by itself. `residual`: measured - model of all rows of all runs, concatenated. m
std::vector<ResidualShape> residual_shapes(const Evidence& evidence, const PlantModel& model,
                                           const std::vector<double>& residual);

}  // namespace biopsy::sim::gap
