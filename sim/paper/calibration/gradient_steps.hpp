// Levenberg-Marquardt along the rows' sensitivities. Several dampings are tried at once, in parallel: within
// the few steps that a search can pay for, a refused step would cost a whole Jacobian.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/paper/calibration/objective.hpp"

namespace biopsy::sim::calibration {

// Clamped to the parameters' ranges.
Eigen::VectorXd within(const std::vector<Parameter>& parameters, Eigen::VectorXd z);

enum class Differences : std::uint8_t {
  Forward,  // half the evaluations: for a search from far away
  Central,
};

struct Descent {
  Eigen::VectorXd z;  // within the ranges; never worse than the start
  int evaluations = 0;
};

// Levenberg-Marquardt from z.
Descent descend(const Question& question, const Eigen::VectorXd& z, int steps, Pull pull,
                Differences differences);

// Sensitivities of the readings to the parameters, without the priors' own: one row per reading, in bands per
// prior std.
Eigen::MatrixXd sensitivities(const Question& question, const Eigen::VectorXd& z);

}  // namespace biopsy::sim::calibration
