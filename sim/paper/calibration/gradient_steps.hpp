// Levenberg-Marquardt along the rows' sensitivities. Several dampings are tried at once, in parallel: within
// the few steps that a search can pay for, a refused step would cost a whole Jacobian.
#pragma once

#include <Eigen/Core>
#include <stop_token>
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

// Levenberg-Marquardt from z. `stop` ends it after a whole step.
Descent descend(const Question& question, const Eigen::VectorXd& z, int steps, Pull pull,
                Differences differences, const std::stop_token& stop = {});

// d residuals / d z at z by forward differences, of the parameters from `first` on.
Eigen::MatrixXd slopes(const Question& question, const Eigen::VectorXd& z, Pull pull, Eigen::Index first);

// Levenberg-Marquardt from z with `slopes` of all parameters there. They are not computed again but corrected
// by what each trial shows (Broyden 1965): a step costs kEvaluationsAlong evaluations.
inline constexpr int kEvaluationsAlong = 4;
Descent descend_along(const Question& question, const Eigen::VectorXd& z, Eigen::MatrixXd slopes, int steps,
                      Pull pull);

// Sensitivities of the readings to the parameters, without the priors' own: one row per reading, in bands per
// prior std.
Eigen::MatrixXd sensitivities(const Question& question, const Eigen::VectorXd& z);

}  // namespace biopsy::sim::calibration
