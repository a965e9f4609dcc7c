// Least squares of a hypothesis on the training runs, by Ceres' trust region with simulated derivatives.
#pragma once

#include <Eigen/Core>

#include "sim/gap/fit/unknowns.hpp"

namespace biopsy::sim::gap {

// How many independent effective_sample_size a stretch of time gives. Readings are dense, but what a model
// misses comes back with every cycle of the drive: neighbours and cycles err together, and counting each
// reading would take a difference in form (how friction sets in, say) for a discovery.
double independent_looks(double seconds);

// d residual / d theta over the training rows; one column an unknown. Forward differences.
Eigen::MatrixXd sensitivities(const Hypothesis& hypothesis, const Evidence& evidence,
                              const std::vector<double>& residual_now);

// Weight of one squared residual against one squared prior: independent effective_sample_size at the present
// misfit. 1/m^2
double residual_weight(const Evidence& evidence, double mean_square);

// Moves the unknowns to the optimum; `iterations` bounds the work. While something may still be missing the
// calibration holds the baseline's numbers back (trust 1); a model that lacks nothing lets the readings
// speak: `trust` times the weight.
void fit(Hypothesis& hypothesis, const Evidence& evidence, int iterations, double trust = 1.0);
inline constexpr double kNothingMissing = 100.0;

// Fills the unknowns' standard deviations: the larger of what white noise of the residual's size allows and
// what the scatter from one second to the next does (a sandwich estimate, for residuals that are correlated).
void estimate_uncertainty(Hypothesis& hypothesis, const Evidence& evidence);

}  // namespace biopsy::sim::gap
