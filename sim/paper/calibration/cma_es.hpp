// Covariance matrix adaptation: minimises a function of a few dozen variables with many local minima and
// without gradients. Hansen 2016, The CMA Evolution Strategy: A Tutorial (arXiv:1604.00772), defaults of its
// table 1.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <stop_token>

namespace biopsy::sim::calibration {

struct CmaSettings {
  double spread = 0.3;     // first standard deviation in every direction: scale the variables to about 1
  int population = 0;      // 0: 4 + 3 ln(dimension), the tutorial's
  int evaluations = 1000;  // at most; the last generation is always whole
  double narrow = 1e-6;    // stops where the spread is below
  std::uint64_t seed = 1;
  std::stop_token stop = {};  // ends the search after a whole generation
};

struct CmaResult {
  Eigen::VectorXd best;
  double value = 0.0;
  int evaluations = 0;
};

using Cost = std::function<double(const Eigen::VectorXd&)>;
// Called after each generation: share of the evaluations used, and the best value so far.
using CmaProgress = std::function<void(double share, double best)>;

// The best point seen, `start` included. A generation is evaluated in parallel; drawing is seeded and serial,
// so the result is the same on any number of cores. Values that are not finite count as the worst.
CmaResult minimise(const Cost& cost, const Eigen::VectorXd& start, const CmaSettings& settings,
                   const CmaProgress& progress = {});

}  // namespace biopsy::sim::calibration
