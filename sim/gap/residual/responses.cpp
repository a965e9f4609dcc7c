#include "sim/gap/residual/responses.hpp"

#include <algorithm>

#include "sim/gap/residual/predict.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kUnknownStep = 2e-3;  // of theta
constexpr double kForceShare = 0.01;   // of the rig's largest force; of the stack's, a weight of
constexpr double kStackForce = 0.005;  // N

}  // namespace

Responses::Responses(const Hypothesis& hypothesis, const Evidence& evidence)
    : hypothesis_(hypothesis), evidence_(evidence), now_(residual(hypothesis.model, evidence, Part::All)) {
  const double share = evidence.u_max * kForceShare;
  force_ = hypothesis.model.baseline.drive == Drive::Force ? std::max(share, 1e-9) : kStackForce;
}

Eigen::VectorXd Responses::now() const {
  return column_of(now_);
}

Eigen::VectorXd Responses::of_unknown(std::size_t i) const {
  std::vector<double> thetas;
  for (const Unknown& u : hypothesis_.unknowns) thetas.push_back(u.theta);
  thetas[i] += kUnknownStep;
  return (column_of(residual(hypothesis_.at(thetas), evidence_, Part::All)) - now()) / kUnknownStep;
}

Eigen::VectorXd Responses::of_force(const std::vector<double>& shape) const {
  Evidence pushed = evidence_;
  std::size_t at = 0;
  for (EvidenceRun& run : pushed.runs)
    for (Row& row : run.rows) row.external_force += force_ * shape[at++];
  return (column_of(residual(hypothesis_.model, pushed, Part::All)) - now()) / force_;
}

}  // namespace biopsy::sim::gap
