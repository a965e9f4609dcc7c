// Least squares of eq. (2) through the charges of all runs: three numbers for the circuit, and one offset of
// the monitor for each run.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/paper/identification/charge_record.hpp"

namespace biopsy::sim::identification {

struct ChargeFit {
  double decay = 0.0, jump = 0.0;                        // F, C1 K and C1 (1-K)
  double log_tau = 0.0;                                  // of seconds
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of these three; widened where the model misfits
  std::vector<double> offsets, offset_stds;              // A, one a run
  double noise = 0.0;                                    // A of one sample
  double misfit = 1.0;                                   // rms residual, in that noise
  bool regular = false;  // false: some direction of the parameters is not identifiable
};

// At least one record, each with a step. tau is searched between two rows and a hundred times the longest
// run.
ChargeFit fit_charges(const std::vector<ChargeRecord>& records);

// Fitted mean current of each stretch, with the offset of the record's run. A
std::vector<double> fitted_currents(const ChargeRecord& record, const ChargeFit& fit, double offset);

}  // namespace biopsy::sim::identification
