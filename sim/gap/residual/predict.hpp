// Predicted readings of the measured runs.
#pragma once

#include <functional>
#include <vector>

#include "sim/gap/select/evidence_runs.hpp"
#include "sim/plant/plant.hpp"

namespace biopsy::sim::gap {

enum class Part : std::uint8_t { Training, HeldOut, All };

// Readings of the model at the rows of a run before `rows`; m. NaN where the model is too stiff for the
// evidence's shortest step.
std::vector<double> predict(PlantModel model, const Evidence& evidence, const EvidenceRun& run,
                            std::size_t rows);

// The same simulation, for what else it shows: calls visit(model, state) at each of these rows.
using RowVisitor = std::function<void(const PlantModel& model, const PlantState& state)>;
void visit_rows(PlantModel model, const Evidence& evidence, const EvidenceRun& run, std::size_t rows,
                const RowVisitor& visit);

// Step of the integrator for this model, s; rows are cut into such steps. Follows the model's fastest rate,
// within the limits of the evidence.
double integrator_step(PlantModel model, const Evidence& evidence);

// The model with the phase of its periodic disturbance, if it has one, fitted to the rows of this run before
// `rows`: recordings do not start at a fixed phase of the disturbance.
PlantModel in_step(PlantModel model, const Evidence& evidence, const EvidenceRun& run, std::size_t rows);

// measured - model over one part of all runs, concatenated, each run in step. m
std::vector<double> residual(const PlantModel& model, const Evidence& evidence, Part part);

// Infinite where a simulation diverged: worse than any other.
double mean_square(const std::vector<double>& values);

}  // namespace biopsy::sim::gap
