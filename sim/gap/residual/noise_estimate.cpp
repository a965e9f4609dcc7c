#include "sim/gap/residual/noise_estimate.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "robot/common/statistics.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr Eigen::Index kLags = 6;
constexpr std::size_t kFewestForLags = 300;  // rows
constexpr double kMotionIn = 0.85;           // of the differences' scatter, below which they contain motion
constexpr double kInputRidge = 1e-12;

// Scatter of one run's differences of the given order, scaled to that of a single white reading.
double difference_scatter(std::vector<double> values, int order) {
  double gain = 1.0;  // variance of the order-th difference of unit white noise: (2n)! / (n!)^2
  for (int n = 1; n <= order; ++n) gain *= 2.0 * (2.0 * n - 1.0) / n;
  for (int n = 0; n < order; ++n) {
    std::adjacent_difference(values.begin(), values.end(), values.begin());
    values.erase(values.begin());
  }
  for (double& value : values) value = std::abs(value);
  return kMadToSigma * median(std::move(values)) / std::sqrt(gain);
}

// Resolution of the sensor: the smallest change between neighbouring readings.
double resolution(const std::vector<double>& values) {
  double finest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i] != values[i - 1]) finest = std::min(finest, std::abs(values[i] - values[i - 1]));
  return std::isfinite(finest) ? finest : 0.0;
}

// Lagged readings and inputs, deviations from their means, one row a moment.
Eigen::MatrixXd lagged(const std::vector<double>& values, std::size_t of) {
  const auto rows = static_cast<Eigen::Index>(of) - kLags;
  const double middle = mean(values);
  Eigen::MatrixXd out(rows, kLags + 1);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index lag = 0; lag <= kLags; ++lag)
      out(i, lag) = values[static_cast<std::size_t>(i + lag)] - middle;
  return out;
}

// Scatter about the best linear difference equation; the gain of its coefficients is one.
double equation_scatter(const RecordedRun& run) {
  const std::size_t rows = std::min(run.displacement.size(), run.input.size());
  if (rows < kFewestForLags) return std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd Y = lagged(run.displacement, rows), U = lagged(run.input, rows);
  Eigen::MatrixXd inputs = U.transpose() * U;
  inputs.diagonal().array() += kInputRidge * std::max(1.0, inputs.trace());
  const Eigen::MatrixXd by_input = inputs.ldlt().solve(U.transpose() * Y);
  const Eigen::MatrixXd left = Y - U * by_input;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(left.transpose() * left);
  const Eigen::VectorXd scatter = (left * solver.eigenvectors().col(0)).cwiseAbs();
  const double few = std::sqrt(2.0 * static_cast<double>(kLags + 1) / static_cast<double>(left.rows()));
  return kMadToSigma * median(std::vector<double>(scatter.begin(), scatter.end())) / (1.0 - few);
}

double of_run(const RecordedRun& run) {
  // Motion only adds to a difference: the order with the least scatter is closest to the noise.
  double least = std::numeric_limits<double>::infinity();
  for (int order = 2; order <= 6; ++order)
    least = std::min(least, difference_scatter(run.displacement, order));
  if (const double equation = equation_scatter(run); equation < kMotionIn * least) least = equation;
  return std::max(least, resolution(run.displacement) / std::sqrt(12.0));
}

}  // namespace

NoiseEstimate estimate_noise(const std::vector<RecordedRun>& runs) {
  std::vector<double> scatters;
  for (const RecordedRun& run : runs) scatters.push_back(of_run(run));
  const double value = std::max(1e-9, median(scatters));
  std::vector<double> apart;
  for (const double scatter : scatters) apart.push_back(std::abs(scatter - value));
  return {value, kMadToSigma * median(apart) / std::sqrt(static_cast<double>(scatters.size()))};
}

}  // namespace biopsy::sim::gap
