#include "sim/paper/calibration/identifiability.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace biopsy::sim::calibration {
namespace {

constexpr double kNamed = 0.3;  // of a direction's length: smaller shares are not named
// Information equal to the prior's halves the variance.
const double kToldStd = std::sqrt(0.5);

std::string named(const std::vector<Parameter>& parameters, Eigen::VectorXd direction) {
  std::vector<std::size_t> order(parameters.size());
  std::iota(order.begin(), order.end(), 0);
  const auto share = [&](std::size_t i) { return std::abs(direction[static_cast<Eigen::Index>(i)]); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return share(a) > share(b); });
  if (direction[static_cast<Eigen::Index>(order.front())] < 0.0) direction = -direction;
  std::string text;
  for (const std::size_t i : order)
    if (text.empty() || share(i) >= kNamed)
      text += fmt::format("{}{:+.2f} {}", text.empty() ? "" : " ", direction[static_cast<Eigen::Index>(i)],
                          parameters[i].name);
  return text;
}

}  // namespace

Identifiability identifiability(const std::vector<Parameter>& parameters, const Eigen::MatrixXd& J) {
  const auto n = static_cast<Eigen::Index>(parameters.size());
  const Eigen::MatrixXd information = J.transpose() * J + Eigen::MatrixXd::Identity(n, n);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solved(information);
  Identifiability out;
  out.covariance = information.inverse();
  for (Eigen::Index i = n; i-- > 0;) {
    const double std = 1.0 / std::sqrt(solved.eigenvalues()[i]);
    out.directions.push_back({std, named(parameters, solved.eigenvectors().col(i))});
    if (std < kToldStd) ++out.told;
  }
  return out;
}

}  // namespace biopsy::sim::calibration
