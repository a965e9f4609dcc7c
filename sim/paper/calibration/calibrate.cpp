#include "sim/paper/calibration/calibrate.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "robot/common/in_parallel.hpp"

namespace biopsy::sim::calibration {
namespace {

constexpr double kStride = 0.05;  // step of differences, in prior stds: above the figures' discretisation
constexpr std::uint64_t kOtherDraws = 1000;  // seeds of the second search differ from those of the first
constexpr double kOnlyPrior = 0.9;           // of the prior std, which is 1

using Vector = Eigen::VectorXd;
using Residuals = std::function<Vector(const Question&, const Vector&, bool)>;

Vector robust_residuals(const Question& question, const Vector& z, bool parallel) {
  return residuals(question, z, parallel, Pull::Robust);
}

// Clamped to the parameters' ranges.
Vector within(const std::vector<Parameter>& parameters, Vector z) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    double& here = z[static_cast<Eigen::Index>(i)];
    here = to_search(parameters[i], from_search(parameters[i], here));
  }
  return z;
}

// Central differences, all points in parallel; at the edge of a parameter's range one-sided.
Eigen::MatrixXd jacobian(const Question& question, const Vector& z, const Residuals& f) {
  std::vector<Vector> ahead(z.size()), behind(z.size());
  Vector apart = Vector::Zero(z.size());
  const Vector here = within(question.parameters, z);  // Ceres has no bounds here
  const auto moved = [&](Eigen::Index parameter, double by) {
    Vector point = here;
    point[parameter] += by;
    point[parameter] = within(question.parameters, point)[parameter];
    return point;
  };
  for (Eigen::Index i = 0; i < z.size(); ++i) apart[i] = moved(i, kStride)[i] - moved(i, -kStride)[i];
  in_parallel(2 * static_cast<std::size_t>(z.size()), [&](std::size_t i) {
    const auto parameter = static_cast<Eigen::Index>(i / 2);
    (i % 2 == 0 ? ahead : behind)[i / 2] =
        f(question, moved(parameter, i % 2 == 0 ? kStride : -kStride), false);
  });
  Eigen::MatrixXd out(ahead.front().size(), z.size());
  for (Eigen::Index i = 0; i < z.size(); ++i) out.col(i) = (ahead[i] - behind[i]) / apart[i];
  return out;
}

class RowsForCeres : public ceres::CostFunction {
 public:
  RowsForCeres(const Question& question, int rows) : question_(question) {
    set_num_residuals(rows);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(question.parameters.size()));
  }

  bool Evaluate(const double* const* parameters, double* out, double** jacobians) const override {
    const Vector z =
        Eigen::Map<const Vector>(parameters[0], static_cast<Eigen::Index>(question_.parameters.size()));
    Eigen::Map<Vector>(out, num_residuals()) = residuals(question_, z, true);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(jacobians[0], num_residuals(), z.size()) = jacobian(question_, z, robust_residuals);
    return true;
  }

 private:
  const Question& question_;
};

// Levenberg-Marquardt never leaves a point for a worse one.
Vector last_steps(const Question& question, Vector z, int steps) {
  const int rows = static_cast<int>(residuals(question, z, true).size());
  ceres::Problem problem;
  problem.AddResidualBlock(new RowsForCeres(question, rows), nullptr, z.data());
  ceres::Solver::Options options;
  options.max_num_iterations = steps;
  options.linear_solver_type = ceres::DENSE_QR;
  options.initial_trust_region_radius = 1.0;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return z;
}

// Covariance of the parameters in units of their prior stds: the std of a number of the paper is its band,
// and the priors count in full.
Eigen::MatrixXd covariance(const Question& question, const Vector& z) {
  const Eigen::MatrixXd J =
      jacobian(question, z, readings).topRows(readings(question, z, true).size() - z.size());
  const Eigen::MatrixXd information = J.transpose() * J + Eigen::MatrixXd::Identity(z.size(), z.size());
  return information.inverse();
}

CalibratedParameter found(const Parameter& parameter, double z, double std) {
  CalibratedParameter out{parameter, from_search(parameter, z)};
  out.only_prior = std >= kOnlyPrior;
  out.std = parameter.doubt * std * (parameter.share ? 1.0 : out.value);
  out.at_bound = out.value <= parameter.low || out.value >= parameter.high;
  return out;
}

Vector first_guess(const std::vector<Parameter>& parameters) {
  Vector z(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i)
    z[static_cast<Eigen::Index>(i)] = to_search(parameters[i], parameters[i].start);
  return z;
}

std::size_t rows_reached(const Question& question, const Vector& z) {
  const std::vector<PaperRow> rows = rows_at(question, z, true);
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const PaperRow& row) { return row.ok; }));
}

}  // namespace

Calibration calibrate(const Question& question, const CalibrationSettings& settings,
                      const CalibrationProgress& progress) {
  const auto say = [&](double share, const std::string& doing) {
    if (progress) progress(share, doing);
  };
  const auto cost = [&](const Vector& z) { return residuals(question, z, false).squaredNorm(); };
  const Vector first = first_guess(question.parameters);
  Calibration out;
  out.before = cost(first);
  const double far_share = settings.far / (settings.far + settings.evaluations + 1.0);
  Vector from = first;
  if (settings.far > 0) {
    const CmaResult near = minimise(
        [&](const Vector& z) { return residuals(question, z, false, Pull::Even).squaredNorm(); }, first,
        {.spread = settings.far_spread,
         .population = settings.population,
         .evaluations = settings.far,
         .seed = settings.seed,
         .stop = settings.stop},
        [&](double share, double best) {
          say(0.9 * far_share * share, fmt::format("first search, cost {:.1f}", best));
        });
    from = within(question.parameters, near.best);
    out.evaluations = near.evaluations;
  }
  const CmaSettings search{.spread = settings.spread,
                           .population = settings.population,
                           .evaluations = settings.evaluations,
                           .seed = settings.seed + (settings.far > 0 ? kOtherDraws : 0),
                           .stop = settings.stop};
  const CmaResult global = minimise(cost, from, search, [&](double share, double best) {
    say(0.9 * (far_share + (1.0 - far_share) * share),
        fmt::format("searching, cost {:.1f} at first, {:.2f} now", out.before, best));
  });
  // The sum of squares approximates the number of rows met: of the results from both starts, take the one
  // that meets more.
  Vector z = within(question.parameters, global.best);
  std::size_t reached = rows_reached(question, z);
  for (const Vector& begin : {z, within(question.parameters, from)}) {
    if (settings.stop.stop_requested()) break;
    say(0.9, fmt::format("last steps, {} rows met", reached));
    const Vector end = within(question.parameters, last_steps(question, begin, settings.last_steps));
    const std::size_t rows = rows_reached(question, end);
    if (rows > reached || (rows == reached && cost(end) < cost(z))) z = end, reached = rows;
  }
  say(0.97, "standard deviations");
  out.interrupted = settings.stop.stop_requested();
  Vector stds = Vector::Constant(z.size(), std::numeric_limits<double>::quiet_NaN());
  if (!out.interrupted) {
    const Eigen::MatrixXd C = covariance(question, z);
    stds = C.diagonal().cwiseSqrt();
    out.correlations = stds.cwiseInverse().asDiagonal() * C * stds.cwiseInverse().asDiagonal();
  }
  out.model = turned(question.start, question.parameters, z);
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    out.parameters.push_back(found(question.parameters[i], z[i], stds[i]));
    out.parameters.back().value =
        value_of(out.model, question.parameters[i].name);  // breakaway is at least sliding
  }
  out.rows = rows_at(question, z, true);
  out.runs = run_fits(question, z);
  out.after = cost(z);
  out.kept_start = z == within(question.parameters, first);
  out.evaluations += global.evaluations;
  return out;
}

}  // namespace biopsy::sim::calibration
