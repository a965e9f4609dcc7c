#include "sim/paper/calibration/gradient_steps.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
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

// Of the parameters from `first` on. At the upper edge of a range backward.
Eigen::MatrixXd forward_differences(const std::vector<Parameter>& parameters, const Vector& z,
                                    const Vector& here, const Residuals& f, Eigen::Index first = 0) {
  Eigen::MatrixXd out(here.size(), z.size() - first);
  in_parallel(static_cast<std::size_t>(z.size() - first), [&](std::size_t i) {
    const auto parameter = first + static_cast<Eigen::Index>(i);
    Vector point = moved(parameters, z, parameter, kFarStride);
    if (point[parameter] - z[parameter] < 0.5 * kFarStride)
      point = moved(parameters, z, parameter, -kFarStride);
    out.col(parameter - first) = (f(point) - here) / (point[parameter] - z[parameter]);
  });
  return out;
}

// Damping of Levenberg-Marquardt that is tried at once, times the last that helped.
constexpr std::array kDampings{0.03, 0.3, 3.0, 30.0};
static_assert(kDampings.size() == kEvaluationsAlong);
constexpr double kFirstDamping = 0.1, kLeastDamping = 1e-4, kMostDamping = 1e4;
constexpr double kFarthestStep = 1.5;  // prior stds of any parameter
constexpr double kGain = 2e-3;         // of the cost: less ends the descent

struct Trial {
  double damping = 0.0;
  Vector z, residuals;
};

// The steps of all dampings from one point, their residuals computed in parallel; the best.
Trial best_trial(const std::vector<Parameter>& parameters, const Vector& z, const Vector& r,
                 const Eigen::MatrixXd& J, double damping, const Residuals& f) {
  std::array<Trial, kDampings.size()> trials;
  in_parallel(trials.size(), [&](std::size_t i) {
    Trial& trial = trials[i];
    trial.damping = damping * kDampings[i];
    Eigen::MatrixXd A = J.transpose() * J;
    A.diagonal().array() += trial.damping;
    Vector step = -A.ldlt().solve(J.transpose() * r);
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > kFarthestStep) step *= kFarthestStep / longest;
    trial.z = within(parameters, z + step);
    trial.residuals = f(trial.z);
  });
  return *std::min_element(trials.begin(), trials.end(), [](const Trial& one, const Trial& other) {
    return one.residuals.squaredNorm() < other.residuals.squaredNorm();
  });
}

}  // namespace

Vector within(const std::vector<Parameter>& parameters, Vector z) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    double& here = z[static_cast<Eigen::Index>(i)];
    here = to_search(parameters[i], from_search(parameters[i], here));
  }
  return z;
}

Descent descend(const Question& question, const Vector& start, int steps, Pull pull, Differences differences,
                const std::stop_token& stop) {
  const std::vector<Parameter>& parameters = question.parameters;
  const auto f = [&](const Vector& point) { return residuals(question, point, false, pull); };
  Descent out{within(parameters, start), 1};
  Vector r = residuals(question, out.z, true, pull);
  double damping = kFirstDamping;
  Eigen::MatrixXd J;  // at out.z; empty where z has moved
  for (int step = 0; step < steps && damping <= kMostDamping && !stop.stop_requested(); ++step) {
    if (J.size() == 0) {
      const bool forward = differences == Differences::Forward;
      J = forward ? forward_differences(parameters, out.z, r, f) : central_differences(parameters, out.z, f);
      out.evaluations += static_cast<int>((forward ? 1 : 2) * out.z.size());
    }
    out.evaluations += static_cast<int>(kDampings.size());
    const Trial best = best_trial(parameters, out.z, r, J, damping, f);
    const double before = r.squaredNorm(), after = best.residuals.squaredNorm();
    if (!(after < before)) {
      damping *= kDampings.back();
      continue;
    }
    out.z = best.z;
    r = best.residuals;
    J.resize(0, 0);
    damping = std::max(kLeastDamping, best.damping);
    if (after > (1.0 - kGain) * before) break;
  }
  return out;
}

Eigen::MatrixXd slopes(const Question& question, const Vector& z, Pull pull, Eigen::Index first) {
  const auto f = [&](const Vector& point) { return residuals(question, point, false, pull); };
  return forward_differences(question.parameters, z, residuals(question, z, true, pull), f, first);
}

Descent descend_along(const Question& question, const Vector& start, Eigen::MatrixXd slopes, int steps,
                      Pull pull) {
  const auto f = [&](const Vector& point) { return residuals(question, point, false, pull); };
  Descent out{within(question.parameters, start), 1};
  Vector r = residuals(question, out.z, true, pull);
  double damping = kFirstDamping;
  for (int step = 0; step < steps && damping <= kMostDamping; ++step) {
    out.evaluations += kEvaluationsAlong;
    const Trial best = best_trial(question.parameters, out.z, r, slopes, damping, f);
    const Vector moved = best.z - out.z, change = best.residuals - r;
    if (moved.squaredNorm() > 0.0)
      slopes += (change - slopes * moved) * moved.transpose() / moved.squaredNorm();
    if (best.residuals.squaredNorm() < r.squaredNorm()) {
      out.z = best.z;
      r = best.residuals;
      damping = std::max(kLeastDamping, best.damping);
    } else {
      damping *= kDampings.back();
    }
  }
  return out;
}

Eigen::MatrixXd sensitivities(const Question& question, const Vector& z) {
  const auto f = [&](const Vector& point) { return readings(question, point, false); };
  const Eigen::MatrixXd all = central_differences(question.parameters, within(question.parameters, z), f);
  return all.topRows(all.rows() - z.size());
}

}  // namespace biopsy::sim::calibration
