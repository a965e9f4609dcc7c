#include "sim/gap/fit/fit.hpp"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "robot/common/in_parallel.hpp"
#include "sim/gap/residual/predict.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kSampleSeconds = 2.0;  // a model's errors repeat with every cycle and ramp of the drive
constexpr double kFewestSamples = 30.0;
constexpr double kBlockSeconds = 1.0;
constexpr double kToleranceOfNoise = 0.1;
constexpr double kWidestRange = 1e6;  // of theta
constexpr int kLineSearchSteps = 4;   // then the trust region shrinks instead
constexpr int kMostFits = 3;
constexpr double kMuchLess = 0.7;  // mean square, that changes the weight of the readings
constexpr int kRefresh = 6;  // iterations between updates of the calibration's columns, which hardly change

double difference_step(const Unknown& u) {
  double h = 2e-3;  // logarithms: 0.2 % of the value
  if (!u.logarithmic) h = 5e-3 * std::max(std::abs(u.theta), 0.2);
  if (u.effect >= 0) {
    const Role role = library_effect(u.effect).parameters[u.parameter].role;
    if (role == Role::Frequency) h = 0.02;
    if (role == Role::Place || role == Role::Level) h = 2e-3;
  }
  return u.theta + h <= u.high ? h : -h;
}

bool is_calibration(const Unknown& u) {
  return std::isfinite(u.prior_std);
}

// Standard deviation before any reading; without a prior that of its range.
double prior_deviation(const Unknown& u) {
  const double range = std::min(u.high - u.low, kWidestRange) / std::sqrt(12.0);
  return is_calibration(u) ? u.prior_std : range;
}

std::vector<double> thetas_of(const Hypothesis& hypothesis) {
  std::vector<double> thetas;
  for (const Unknown& u : hypothesis.unknowns) thetas.push_back(u.theta);
  return thetas;
}

Eigen::VectorXd sensitivity(const Hypothesis& hypothesis, std::size_t unknown, const Evidence& evidence,
                            const std::vector<double>& now) {
  std::vector<double> thetas = thetas_of(hypothesis);
  const double h = difference_step(hypothesis.unknowns[unknown]);
  thetas[unknown] += h;
  const std::vector<double> moved = residual(hypothesis.at(thetas), evidence, Part::Training);
  const auto rows = static_cast<Eigen::Index>(now.size());
  return (Eigen::Map<const Eigen::VectorXd>(moved.data(), rows) -
          Eigen::Map<const Eigen::VectorXd>(now.data(), rows)) /
         h;
}

bool are_finite(const double* values, std::size_t count) {
  return std::isfinite(std::accumulate(values, values + count, 0.0));
}

// The training residuals, then one row for each unknown with a prior.
class Misfit : public ceres::CostFunction {
 public:
  // `now`: the training residuals of the hypothesis.
  Misfit(const Hypothesis& hypothesis, const Evidence& evidence, double weight, std::vector<double> now)
      : hypothesis_(hypothesis),
        evidence_(evidence),
        last_at_(thetas_of(hypothesis)),
        last_(std::move(now)),
        root_(std::sqrt(weight)),
        rows_(last_.size()) {
    seen_.emplace_back(last_at_, mean_square(last_));
    for (std::size_t i = 0; i < hypothesis.unknowns.size(); ++i)
      if (std::isfinite(hypothesis.unknowns[i].prior_std)) known_.push_back(i);
    set_num_residuals(static_cast<int>(rows_ + known_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(hypothesis.unknowns.size()));
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Hypothesis here = hypothesis_;
    const std::vector<double> at(parameters[0], parameters[0] + here.unknowns.size());
    here.set(at);
    if (at != last_at_) {
      last_at_ = at, last_ = residual(here.model, evidence_, Part::Training);
      seen_.emplace_back(at, mean_square(last_));
    }
    const std::vector<double>& now = last_;
    for (std::size_t i = 0; i < rows_; ++i) residuals[i] = root_ * now[i];
    for (std::size_t k = 0; k < known_.size(); ++k) {
      const Unknown& u = here.unknowns[known_[k]];
      residuals[rows_ + k] = (u.theta - u.prior_mean) / u.prior_std;
    }
    if (jacobians != nullptr && jacobians[0] != nullptr) differentiate(here, now, jacobians[0]);
    // Ceres takes a shorter step where there is no value; a derivative without value it would print.
    return are_finite(residuals, rows_) &&
           (jacobians == nullptr || jacobians[0] == nullptr ||
            are_finite(jacobians[0], static_cast<std::size_t>(num_residuals()) * here.unknowns.size()));
  }

  // Mean square of the residuals where Ceres ended, m^2: of a place that it tried.
  double square_at(const std::vector<double>& thetas) const {
    for (const auto& [at, square] : seen_)
      if (at == thetas) return square;
    return mean_square(residual(hypothesis_.at(thetas), evidence_, Part::Training));
  }

 private:
  void differentiate(const Hypothesis& here, const std::vector<double>& now, double* jacobian) const {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor> J(jacobian, num_residuals(), static_cast<Eigen::Index>(here.unknowns.size()));
    J.setZero();
    const bool all = age_++ % kRefresh == 0;
    if (all)
      columns_ = sensitivities(here, evidence_, now);
    else
      differentiate_again(here, now);
    J.topRows(static_cast<Eigen::Index>(rows_)) = root_ * columns_;
    for (std::size_t k = 0; k < known_.size(); ++k)
      J(static_cast<Eigen::Index>(rows_ + k), static_cast<Eigen::Index>(known_[k])) =
          1.0 / here.unknowns[known_[k]].prior_std;
  }

  void differentiate_again(const Hypothesis& here, const std::vector<double>& now) const {
    in_parallel(here.unknowns.size(), [&](std::size_t i) {
      if (!is_calibration(here.unknowns[i]))
        columns_.col(static_cast<Eigen::Index>(i)) = sensitivity(here, i, evidence_, now);
    });
  }

  const Hypothesis& hypothesis_;
  const Evidence& evidence_;
  mutable Eigen::MatrixXd columns_;
  mutable int age_ = 0;
  mutable std::vector<double> last_at_, last_;  // Ceres evaluates the derivative where it had the value
  mutable std::vector<std::pair<std::vector<double>, double>> seen_;  // thetas and mean squares, m^2
  double root_;
  std::size_t rows_;
  std::vector<std::size_t> known_;
};

// Blocks of rows whose errors count as one draw: one second of one run.
std::vector<std::pair<std::size_t, std::size_t>> blocks(const Evidence& evidence) {
  std::vector<std::pair<std::size_t, std::size_t>> out;
  std::size_t at = 0;
  for (const EvidenceRun& run : evidence.runs) {
    double begun = 0.0;
    std::size_t from = at;
    for (std::size_t i = 0; i < run.training_rows; ++i, ++at)
      if (run.rows[i].time - begun >= kBlockSeconds) {
        out.emplace_back(from, at);
        from = at, begun = run.rows[i].time;
      }
    if (at > from) out.emplace_back(from, at);
  }
  return out;
}

}  // namespace

double independent_samples(double seconds) {
  return std::max(kFewestSamples, seconds / kSampleSeconds);
}

double residual_weight(const Evidence& evidence, double square_now) {
  double rows = 0.0;
  for (const EvidenceRun& run : evidence.runs) rows += static_cast<double>(run.training_rows);
  const double tolerated = kToleranceOfNoise * evidence.noise;
  return independent_samples(evidence.training_seconds) / (rows * (square_now + tolerated * tolerated));
}

Eigen::MatrixXd sensitivities(const Hypothesis& hypothesis, const Evidence& evidence,
                              const std::vector<double>& residual_now) {
  Eigen::MatrixXd J(static_cast<Eigen::Index>(residual_now.size()),
                    static_cast<Eigen::Index>(hypothesis.unknowns.size()));
  in_parallel(hypothesis.unknowns.size(), [&](std::size_t i) {
    J.col(static_cast<Eigen::Index>(i)) = sensitivity(hypothesis, i, evidence, residual_now);
  });
  return J;
}

double fit(Hypothesis& hypothesis, const Evidence& evidence, int iterations, double trust, double converged) {
  std::vector<double> before = residual(hypothesis.model, evidence, Part::Training);
  const double square = mean_square(before);
  if (hypothesis.unknowns.empty() || !std::isfinite(square)) return square;
  std::vector<double> thetas = thetas_of(hypothesis);
  ceres::Problem::Options owned;
  owned.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  Misfit misfit(hypothesis, evidence, trust * residual_weight(evidence, square), std::move(before));
  ceres::Problem problem(owned);
  problem.AddResidualBlock(&misfit, nullptr, thetas.data());
  for (std::size_t i = 0; i < thetas.size(); ++i) {
    const Unknown& u = hypothesis.unknowns[i];
    if (std::isfinite(u.low)) problem.SetParameterLowerBound(thetas.data(), static_cast<int>(i), u.low);
    if (std::isfinite(u.high)) problem.SetParameterUpperBound(thetas.data(), static_cast<int>(i), u.high);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = iterations;
  options.function_tolerance = converged;
  // Where a step leaves the bounds Ceres searches along it; by values alone, since a derivative costs as many
  // simulations as there are unknowns.
  options.line_search_interpolation_type = ceres::QUADRATIC;
  options.max_num_line_search_step_size_iterations = kLineSearchSteps;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  hypothesis.set(thetas);
  return misfit.square_at(thetas);
}

double fit_closely(Hypothesis& hypothesis, const Evidence& evidence, int iterations) {
  double before = mean_square(residual(hypothesis.model, evidence, Part::Training));
  for (int i = 0; i < kMostFits; ++i) {
    const double now = fit(hypothesis, evidence, iterations);
    if (i + 1 == kMostFits || !(now < kMuchLess * before)) return now;
    before = now;
  }
  return before;
}

void estimate_uncertainty(Hypothesis& hypothesis, const Evidence& evidence) {
  const auto n = static_cast<Eigen::Index>(hypothesis.unknowns.size());
  if (n == 0) return;
  const std::vector<double> r = residual(hypothesis.model, evidence, Part::Training);
  const Eigen::MatrixXd J = sensitivities(hypothesis, evidence, r);
  const double w = 1.0 / std::max(mean_square(r), evidence.noise * evidence.noise);
  Eigen::MatrixXd information = w * J.transpose() * J;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double known = prior_deviation(hypothesis.unknowns[static_cast<std::size_t>(i)]);
    information(i, i) += 1.0 / (known * known);
  }
  const Eigen::MatrixXd inverse = information.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(n, n);
  const auto all = blocks(evidence);
  for (const auto& [from, to] : all) {
    const auto length = static_cast<Eigen::Index>(to - from);
    const Eigen::Map<const Eigen::VectorXd> piece(r.data() + from, length);
    const Eigen::VectorXd pull =
        w * J.middleRows(static_cast<Eigen::Index>(from), length).transpose() * piece;
    scatter += pull * pull.transpose();
  }
  const double few = static_cast<double>(all.size());
  const Eigen::MatrixXd robust = inverse * scatter * inverse * (few / std::max(1.0, few - 1.0));
  // The residual above the noise is the model's error, which repeats every cycle: few independent samples.
  const double square = mean_square(r), above = std::max(0.0, 1.0 - std::pow(evidence.noise, 2) / square);
  const double repeats =
      above * static_cast<double>(r.size()) / independent_samples(evidence.training_seconds);
  const Eigen::MatrixXd coherent = inverse * (1.0 + repeats);
  for (Eigen::Index i = 0; i < n; ++i) {
    hypothesis.unknowns[static_cast<std::size_t>(i)].std =
        std::sqrt(std::max({inverse(i, i), robust(i, i), coherent(i, i)}));
  }
}

}  // namespace biopsy::sim::gap
