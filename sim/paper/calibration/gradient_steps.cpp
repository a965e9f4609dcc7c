#include "sim/paper/calibration/gradient_steps.hpp"

#include <ceres/ceres.h>

#include <functional>

#include "robot/common/in_parallel.hpp"

namespace biopsy::sim::calibration {
namespace {

// Step of differences, in prior stds: above the figures' discretisation; from far away above their roughness.
constexpr double kStride = 0.05, kFarStride = 0.1;

using Vector = Eigen::VectorXd;
using Residuals = std::function<Vector(const Vector&)>;  // called from several threads

Vector moved(const std::vector<Parameter>& parameters, const Vector& z, Eigen::Index parameter, double by) {
  Vector point = z;
  point[parameter] += by;
  point[parameter] = within(parameters, point)[parameter];
  return point;
}

// All points in parallel; at the edge of a parameter's range one-sided. z is within the ranges.
Eigen::MatrixXd central_differences(const std::vector<Parameter>& parameters, const Vector& z,
                                    const Residuals& f) {
  std::vector<Vector> ahead(z.size()), behind(z.size());
  in_parallel(2 * static_cast<std::size_t>(z.size()), [&](std::size_t i) {
    const auto parameter = static_cast<Eigen::Index>(i / 2);
    (i % 2 == 0 ? ahead : behind)[i / 2] =
        f(moved(parameters, z, parameter, i % 2 == 0 ? kStride : -kStride));
  });
  Eigen::MatrixXd out(ahead.front().size(), z.size());
  for (Eigen::Index i = 0; i < z.size(); ++i)
    out.col(i) =
        (ahead[i] - behind[i]) / (moved(parameters, z, i, kStride)[i] - moved(parameters, z, i, -kStride)[i]);
  return out;
}

// At the upper edge of a range backward.
Eigen::MatrixXd forward_differences(const std::vector<Parameter>& parameters, const Vector& z,
                                    const Residuals& f) {
  const Vector here = f(z);
  Eigen::MatrixXd out(here.size(), z.size());
  in_parallel(static_cast<std::size_t>(z.size()), [&](std::size_t i) {
    const auto parameter = static_cast<Eigen::Index>(i);
    Vector point = moved(parameters, z, parameter, kFarStride);
    if (point[parameter] - z[parameter] < 0.5 * kFarStride)
      point = moved(parameters, z, parameter, -kFarStride);
    out.col(parameter) = (f(point) - here) / (point[parameter] - z[parameter]);
  });
  return out;
}

class RowsForCeres : public ceres::CostFunction {
 public:
  RowsForCeres(const Question& question, int rows, Pull pull, Differences differences)
      : question_(question), pull_(pull), differences_(differences) {
    set_num_residuals(rows);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(question.parameters.size()));
  }

  int evaluations() const { return evaluations_; }

  bool Evaluate(const double* const* parameters, double* out, double** jacobians) const override {
    const Vector z =
        Eigen::Map<const Vector>(parameters[0], static_cast<Eigen::Index>(question_.parameters.size()));
    Eigen::Map<Vector>(out, num_residuals()) = residuals(question_, z, true, pull_);
    ++evaluations_;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto f = [this](const Vector& point) { return residuals(question_, point, false, pull_); };
    const Vector here = within(question_.parameters, z);  // Ceres has no bounds here
    const bool forward = differences_ == Differences::Forward;
    Eigen::Map<RowMajor>(jacobians[0], num_residuals(), z.size()) =
        forward ? forward_differences(question_.parameters, here, f)
                : central_differences(question_.parameters, here, f);
    evaluations_ += static_cast<int>(forward ? 1 + z.size() : 2 * z.size());
    return true;
  }

 private:
  const Question& question_;
  Pull pull_;
  Differences differences_;
  mutable int evaluations_ = 0;  // Ceres calls from one thread
};

}  // namespace

Vector within(const std::vector<Parameter>& parameters, Vector z) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    double& here = z[static_cast<Eigen::Index>(i)];
    here = to_search(parameters[i], from_search(parameters[i], here));
  }
  return z;
}

Descent descend(const Question& question, const Vector& z, int steps, Pull pull, Differences differences) {
  Descent out{z};
  const int rows = static_cast<int>(residuals(question, z, true, pull).size());
  auto* cost = new RowsForCeres(question, rows, pull, differences);  // the problem's
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, out.z.data());
  ceres::Solver::Options options;
  options.max_num_iterations = steps;
  options.linear_solver_type = ceres::DENSE_QR;
  options.initial_trust_region_radius = 1.0;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return {within(question.parameters, out.z), cost->evaluations() + 1};
}

Eigen::MatrixXd sensitivities(const Question& question, const Vector& z) {
  const auto f = [&](const Vector& point) { return readings(question, point, false); };
  const Eigen::MatrixXd all = central_differences(question.parameters, within(question.parameters, z), f);
  return all.topRows(all.rows() - z.size());
}

}  // namespace biopsy::sim::calibration
