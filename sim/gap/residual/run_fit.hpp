// How well a model follows each run, in the figures of system identification.
#pragma once

#include <vector>

#include "sim/gap/gap_finding.hpp"
#include "sim/gap/select/evidence_runs.hpp"

namespace biopsy::sim::gap {

// One entry for each run, of a run of which a part was held out two. Residuals are of all rows, in order; m.
std::vector<RunFit> run_fits(const Evidence& evidence, const std::vector<double>& before,
                             const std::vector<double>& after);

// RMS of the held-out readings about the mean of their run, or of their window: what is missed by a model
// that knows only where the plate is. m
double held_out_motion(const Evidence& evidence);

// Every row of every run with both models' readings; mm, and the input in V or N.
std::vector<GapSignals> signals(const Evidence& evidence, const std::vector<double>& before,
                                const std::vector<double>& after);

}  // namespace biopsy::sim::gap
