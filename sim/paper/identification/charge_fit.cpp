#include "sim/paper/identification/charge_fit.hpp"

#include <ceres/crs_matrix.h>
#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

namespace biopsy::sim::identification {
namespace {

// Scales of the unknowns.
constexpr double kFarad = 1e-9, kAmpere = 1e-6;
constexpr int kGrid = 60;                   // time constants tried before the search
constexpr double kLeastEigenvalue = 1e-12;  // of normalised columns: below, a direction is not identifiable
constexpr double kLeastNoise = 1e-9;        // of the largest current: rounding, for data without noise

double change(const ChargeRecord& record, std::size_t m) {
  return record.input[m] - (m > 0 ? record.input[m - 1] : 0.0);
}

// For each stretch the changes du of u_i and dv of u_o with K = 1. V
template <class Number>
void each_stretch(const ChargeRecord& record, const Number& tau, auto&& visit) {
  using std::exp;
  const Number kept = exp(-record.period / tau);
  Number v(0.0);
  for (const Stretch& part : record.parts) {
    const Number before = v;
    double du = 0.0;
    for (std::size_t m = part.from; m < part.to; ++m) {
      const double step = change(record, m);
      du += step;
      v = (v + step) * kept;
    }
    visit(part, du, Number(v - before));
  }
}

double weight_of(const ChargeRecord& record, const Stretch& part, double noise) {
  return 1.0 / (noise * record.period * std::sqrt(static_cast<double>(part.to - part.from)));
}

double seconds(const ChargeRecord& record, const Stretch& part) {
  return record.period * static_cast<double>(part.to - part.from);
}

// charge = A (du_i - dv) + B du_i + offset t, in standard deviations of its noise.
class Residuals {
 public:
  Residuals(const ChargeRecord& record, double noise) : record_(record), noise_(noise) {}

  template <class Number>
  bool operator()(const Number* const* unknown, Number* residual) const {
    using std::exp;
    const Number A = unknown[0][0] * kFarad, B = unknown[0][1] * kFarad, offset = unknown[1][0] * kAmpere;
    each_stretch(record_, Number(exp(unknown[0][2])), [&](const Stretch& part, double du, const Number& dv) {
      const Number fitted = A * (du - dv) + B * du + offset * seconds(record_, part);
      *residual++ = (fitted - part.charge) * weight_of(record_, part, noise_);
    });
    return true;
  }

 private:
  const ChargeRecord& record_;
  double noise_;
};

struct Start {
  double cost = std::numeric_limits<double>::infinity();
  Eigen::VectorXd linear;  // A, B, offsets
  double log_tau = 0.0;
};

// Linear in all but tau: solved for each tau of a grid.
Start linear_fit(const std::vector<ChargeRecord>& records, double noise, double tau) {
  Eigen::Index rows = 0, row = 0;
  for (const ChargeRecord& record : records) rows += static_cast<Eigen::Index>(record.parts.size());
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows, 2 + static_cast<Eigen::Index>(records.size()));
  Eigen::VectorXd charges(rows);
  for (std::size_t r = 0; r < records.size(); ++r)
    each_stretch(records[r], tau, [&](const Stretch& part, double du, double dv) {
      const double weight = weight_of(records[r], part, noise);
      columns(row, 0) = weight * (du - dv) * kFarad;
      columns(row, 1) = weight * du * kFarad;
      columns(row, 2 + static_cast<Eigen::Index>(r)) = weight * seconds(records[r], part) * kAmpere;
      charges(row++) = weight * part.charge;
    });
  Start start;
  start.linear = columns.colPivHouseholderQr().solve(charges);
  start.cost = (columns * start.linear - charges).squaredNorm();
  start.log_tau = std::log(tau);
  return start;
}

Start best_start(const std::vector<ChargeRecord>& records, double noise) {
  double shortest = std::numeric_limits<double>::infinity(), longest = 0.0;
  for (const ChargeRecord& record : records) {
    shortest = std::min(shortest, record.period);
    longest = std::max(longest, record.after_step);
  }
  const double low = std::log(2.0 * shortest), high = std::log(std::max(100.0 * longest, 4.0 * shortest));
  Start best;
  for (int i = 0; i < kGrid; ++i) {
    Start start = linear_fit(records, noise, std::exp(low + (high - low) * i / (kGrid - 1)));
    if (start.cost < best.cost && start.linear[0] > 0.0) best = std::move(start);
  }
  return best;
}

double common_noise(const std::vector<ChargeRecord>& records) {
  double sum = 0.0, largest = 0.0;
  for (const ChargeRecord& record : records) {
    sum += record.noise * record.noise;
    for (const Stretch& part : record.parts)
      largest = std::max(largest, std::abs(part.charge) / seconds(record, part));
  }
  return std::max({std::sqrt(sum / static_cast<double>(records.size())), kLeastNoise * largest, 1e-18});
}

struct Unknowns {
  std::array<double, 3> circuit{};
  std::vector<double> offsets;
};

Eigen::MatrixXd jacobian(ceres::Problem& problem, Unknowns& unknowns) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks.push_back(unknowns.circuit.data());
  for (double& offset : unknowns.offsets) options.parameter_blocks.push_back(&offset);
  ceres::CRSMatrix sparse;
  problem.Evaluate(options, nullptr, nullptr, nullptr, &sparse);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row)
    for (int at = sparse.rows[row]; at < sparse.rows[row + 1]; ++at)
      dense(row, sparse.cols[at]) = sparse.values[at];
  return dense;
}

// False where a direction is not identifiable.
bool read_covariance(Eigen::MatrixXd columns, double scale, ChargeFit& fit) {
  const Eigen::VectorXd lengths = columns.colwise().norm();
  if (!(lengths.minCoeff() > 0.0)) return false;
  columns *= lengths.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> squares(columns.transpose() * columns);
  if (squares.eigenvalues().minCoeff() < kLeastEigenvalue) return false;
  Eigen::VectorXd units = Eigen::VectorXd::Constant(lengths.size(), kAmpere);
  units.head<3>() << kFarad, kFarad, 1.0;
  units = units.cwiseQuotient(lengths);
  const Eigen::MatrixXd inverse = squares.eigenvectors() * squares.eigenvalues().cwiseInverse().asDiagonal() *
                                  squares.eigenvectors().transpose();
  const Eigen::MatrixXd covariance = scale * (units.asDiagonal() * inverse * units.asDiagonal());
  fit.covariance = covariance.topLeftCorner<3, 3>();
  for (Eigen::Index i = 3; i < lengths.size(); ++i) fit.offset_stds.push_back(std::sqrt(covariance(i, i)));
  return true;
}

double solve(ceres::Problem& problem) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return 2.0 * summary.final_cost;
}

}  // namespace

ChargeFit fit_charges(const std::vector<ChargeRecord>& records) {
  ChargeFit fit;
  fit.noise = common_noise(records);
  const Start start = best_start(records, fit.noise);
  fit.offsets.assign(records.size(), 0.0);
  if (!std::isfinite(start.cost)) return fit;  // no positive decay with any time constant
  Unknowns unknowns{{start.linear[0], start.linear[1], start.log_tau}, {}};
  for (std::size_t r = 0; r < records.size(); ++r)
    unknowns.offsets.push_back(start.linear[2 + static_cast<Eigen::Index>(r)]);
  ceres::Problem problem;
  std::size_t rows = 0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    auto cost = std::make_unique<ceres::DynamicAutoDiffCostFunction<Residuals, 4>>(
        new Residuals(records[r], fit.noise));
    cost->AddParameterBlock(3);
    cost->AddParameterBlock(1);
    cost->SetNumResiduals(static_cast<int>(records[r].parts.size()));
    problem.AddResidualBlock(cost.release(), nullptr,
                             std::vector<double*>{unknowns.circuit.data(), &unknowns.offsets[r]});
    rows += records[r].parts.size();
  }
  const double left = solve(problem),
               freedom = static_cast<double>(rows) - 3.0 - static_cast<double>(records.size());
  fit.misfit = freedom > 0.0 ? std::sqrt(left / freedom) : 1.0;
  fit.decay = unknowns.circuit[0] * kFarad;
  fit.jump = unknowns.circuit[1] * kFarad;
  fit.log_tau = unknowns.circuit[2];
  for (std::size_t r = 0; r < records.size(); ++r) fit.offsets[r] = unknowns.offsets[r] * kAmpere;
  fit.regular = freedom > 0.0 &&
                read_covariance(jacobian(problem, unknowns), std::max(1.0, fit.misfit * fit.misfit), fit);
  return fit;
}

std::vector<double> fitted_currents(const ChargeRecord& record, const ChargeFit& fit, double offset) {
  std::vector<double> fitted;
  each_stretch(record, std::exp(fit.log_tau), [&](const Stretch& part, double du, double dv) {
    fitted.push_back((fit.decay * (du - dv) + fit.jump * du) / seconds(record, part) + offset);
  });
  return fitted;
}

}  // namespace biopsy::sim::identification
