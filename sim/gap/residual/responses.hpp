// How the residual of all rows answers to a small change: of an unknown, or of a force on plate A. Linear
// regression on such answers is a fit of forces in the measured motion, without differentiating it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/gap/select/select.hpp"

namespace biopsy::sim::gap {

class Responses {
 public:
  Responses(const Hypothesis& hypothesis, const Evidence& evidence);

  Eigen::VectorXd now() const;                                       // m, the residual itself
  Eigen::VectorXd of_unknown(std::size_t i) const;                   // per theta
  Eigen::VectorXd of_force(const std::vector<double>& shape) const;  // per N; `shape`: N down at each row

 private:
  const Hypothesis& hypothesis_;
  const Evidence& evidence_;
  std::vector<double> now_;
  double force_ = 1.0;  // N
};

inline Eigen::VectorXd column_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace biopsy::sim::gap
