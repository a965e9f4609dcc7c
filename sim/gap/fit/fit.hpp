// Least squares of a hypothesis on the training runs, by Ceres' trust region with simulated derivatives.
#pragma once

#include <Eigen/Core>

#include "sim/gap/fit/unknowns.hpp"

namespace biopsy::sim::gap {

// Number of independent samples in `seconds` of readings. A model's errors are correlated over a cycle of the
// drive and from cycle to cycle: counting each reading would take a small difference in form (for example how
// friction sets in) for evidence.
double independent_samples(double seconds);

// d residual / d theta over the training rows; one column an unknown. Forward differences.
Eigen::MatrixXd sensitivities(const Hypothesis& hypothesis, const Evidence& evidence,
                              const std::vector<double>& residual_now);

// Weight of one squared residual against one squared prior: independent samples over readings, at the present
// mean square. 1/m^2
double residual_weight(const Evidence& evidence, double mean_square);

// Of the cost, the step at which a fit ends: a tenth of a unit of log evidence.
inline constexpr double kConverged = 1e-4;

// Moves the unknowns to the optimum, in at most `iterations`. `trust` multiplies the weight of the readings
// against the priors: 1 while the model may still lack something, kTrustReadings for a complete model. The
// mean square of the training residuals that is left, m^2.
double fit(Hypothesis& hypothesis, const Evidence& evidence, int iterations, double trust = 1.0,
           double converged = kConverged);
inline constexpr double kTrustReadings = 100.0;

// The same, again while it leaves much less: the weight of the readings is that of what is left at the start
// of a fit, so that after a good step the priors would hold the numbers back.
double fit_closely(Hypothesis& hypothesis, const Evidence& evidence, int iterations);

// Fills the unknowns' standard deviations: the largest of the white-noise estimate, the sandwich estimate
// over blocks of a second (correlated residuals), and the estimate for a model error that repeats every
// cycle.
void estimate_uncertainty(Hypothesis& hypothesis, const Evidence& evidence);

}  // namespace biopsy::sim::gap
