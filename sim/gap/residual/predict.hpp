// What a model says that the runs should have shown.
#pragma once

#include <vector>

#include "sim/gap/select/evidence_runs.hpp"

namespace biopsy::sim::gap {

enum class Part : std::uint8_t { Training, HeldOut, All };

// Readings of the model at the rows of a run up to `rows`; m. Not a number where the model is too stiff for
// the evidence's shortest step.
std::vector<double> predict(PlantModel model, const Evidence& evidence, const EvidenceRun& run,
                            std::size_t rows);

// The model with its periodic disturbance, if it has one, in step with this run: nobody starts a recording on
// a breath, so the phase is each run's own. Found from the rows before `rows`.
PlantModel in_step(PlantModel model, const Evidence& evidence, const EvidenceRun& run, std::size_t rows);

// measured - model over one part of all runs, one after the other, each run in step. m
std::vector<double> residual(const PlantModel& model, const Evidence& evidence, Part part);

double mean_square(const std::vector<double>& values);

}  // namespace biopsy::sim::gap
