// What a model says that the runs should have shown.
#pragma once

#include <vector>

#include "sim/gap/evidence_runs.hpp"

namespace biopsy::sim::gap {

enum class Part : std::uint8_t { Training, HeldOut, All };

// Readings of the model at the rows of a run up to `rows`; m. The integrator's step is at most `step_share`
// of the model's fastest rate's time.
std::vector<double> predict(PlantModel model, const EvidenceRun& run, std::size_t rows, double step_share);

// measured - model over one part of all runs, one after the other. m
std::vector<double> residual(const PlantModel& model, const Evidence& evidence, Part part);

double mean_square(const std::vector<double>& values);

}  // namespace biopsy::sim::gap
