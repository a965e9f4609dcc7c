// Which parameters the data tell, by the Fisher information of the readings at the result.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sim/paper/calibration/parameters.hpp"

namespace biopsy::sim::calibration {

// A combination of parameters. `std` in prior stds along it, priors counted: 1 is not told by the data at
// all.
struct Direction {
  double std = 1.0;
  std::string parameters;  // those with a large share, largest first: "+0.82 V0 -0.45 K"
};

struct Identifiability {
  Eigen::MatrixXd covariance;         // in units of the priors' stds, priors counted
  std::vector<Direction> directions;  // orthogonal, best known first
  std::size_t told = 0;               // directions of which the data tell more than the prior
};

// J: sensitivities of the readings, in their stds per prior std, one row a reading.
Identifiability identifiability(const std::vector<Parameter>& parameters, const Eigen::MatrixXd& J);

}  // namespace biopsy::sim::calibration
