#include "sim/gap/residual/straw_men.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/gap/millimetres.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr int kMostOrder = 4;
constexpr double kLeastRows = 200.0;  // of all runs, at the slowest rate
constexpr int kStepFactor = 2;        // between the rates
constexpr double kRidge = 1e-10;      // of the diagonal
constexpr double kDiverged = 1e3;     // times the largest reading

// A run at a lower rate: means of readings and of the inputs that follow them.
struct SlowRun {
  std::vector<double> y, u;
  std::size_t training = 0;
};

std::vector<SlowRun> slowed(const Dataset& dataset, const Evidence& evidence, std::size_t factor) {
  std::vector<SlowRun> out;
  for (std::size_t r = 0; r < dataset.runs.size(); ++r) {
    const RecordedRun& run = dataset.runs[r];
    const EvidenceRun& split = evidence.runs[r];
    SlowRun slow;
    for (std::size_t i = 0; i + factor <= run.displacement.size(); i += factor) {
      double u = 0.0;
      for (std::size_t j = i; j < i + factor; ++j) u += run.input[j] / static_cast<double>(factor);
      slow.y.push_back(run.displacement[i]);
      slow.u.push_back(u);
    }
    const double share = static_cast<double>(split.training_rows) / static_cast<double>(split.rows.size());
    slow.training = static_cast<std::size_t>(share * static_cast<double>(slow.y.size()));
    out.push_back(std::move(slow));
  }
  return out;
}

struct Equation {
  int order = 1;
  bool squared = false;  // the square of the input drives too
  double y_scale = 1.0, u_scale = 1.0;
  Eigen::VectorXd coefficients;

  Eigen::Index size() const { return order * (squared ? 3 : 2) + 1; }
  // Past readings, past inputs and a constant, at row i.
  Eigen::VectorXd terms(const std::vector<double>& y, const std::vector<double>& u, std::size_t i) const {
    Eigen::VectorXd out(size());
    Eigen::Index at = 0;
    for (int lag = 1; lag <= order; ++lag) {
      const std::size_t past = i - static_cast<std::size_t>(lag);
      const double push = u[past] / u_scale;
      out[at++] = y[past] / y_scale;
      out[at++] = push;
      if (squared) out[at++] = push * push;
    }
    out[at] = 1.0;
    return out;
  }
};

void fit(Equation& equation, const std::vector<SlowRun>& runs) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(equation.size(), equation.size());
  Eigen::VectorXd b = Eigen::VectorXd::Zero(equation.size());
  for (const SlowRun& run : runs)
    for (std::size_t i = static_cast<std::size_t>(equation.order); i < run.training; ++i) {
      const Eigen::VectorXd terms = equation.terms(run.y, run.u, i);
      A += terms * terms.transpose();
      b += terms * (run.y[i] / equation.y_scale);
    }
  A.diagonal() *= 1.0 + kRidge;
  A.diagonal().array() += std::numeric_limits<double>::min();
  equation.coefficients = A.ldlt().solve(b);
}

struct EquationMisfit {
  double training = 0.0, held_out = 0.0;  // m^2, mean squares
};

// Simulated from the first readings on: what follows is predicted from the input alone.
EquationMisfit simulated(const Equation& equation, const std::vector<SlowRun>& runs) {
  EquationMisfit sum;
  double training = 0.0, held_out = 0.0;
  for (const SlowRun& run : runs) {
    std::vector<double> y(run.y.begin(),
                          run.y.begin() + std::min<std::ptrdiff_t>(equation.order, std::ssize(run.y)));
    for (std::size_t i = y.size(); i < run.y.size(); ++i) {
      const double next = equation.y_scale * equation.coefficients.dot(equation.terms(y, run.u, i));
      const double most = kDiverged * equation.y_scale;
      y.push_back(std::isfinite(next) ? std::clamp(next, -most, most) : most);
      const double off = std::pow(run.y[i] - y[i], 2);
      if (i < run.training)
        sum.training += off, training += 1.0;
      else
        sum.held_out += off, held_out += 1.0;
    }
  }
  return {sum.training / std::max(1.0, training), sum.held_out / std::max(1.0, held_out)};
}

StrawMan best_equation(const Dataset& dataset, const Evidence& evidence, bool squared) {
  double rows = 0.0;
  for (const RecordedRun& run : dataset.runs) rows += static_cast<double>(run.time.size());
  StrawMan out{.name = squared ? "difference equation in the input and its square"
                               : "linear difference equation in the input"};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t factor = 1; factor == 1 || rows / static_cast<double>(factor) > kLeastRows;
       factor *= kStepFactor) {
    const std::vector<SlowRun> runs = slowed(dataset, evidence, factor);
    for (int order = 1; order <= kMostOrder; ++order) {
      Equation equation{.order = order,
                        .squared = squared,
                        .y_scale = std::max({1e-9, std::abs(evidence.x_low), std::abs(evidence.x_high)}),
                        .u_scale = std::max(1e-9, evidence.u_max),
                        .coefficients = {}};
      fit(equation, runs);
      const EquationMisfit misfit = simulated(equation, runs);
      if (!(misfit.training < least)) continue;
      least = misfit.training;
      out.order = order;
      out.rmse = kMm * std::sqrt(misfit.held_out);
    }
  }
  return out;
}

}  // namespace

std::vector<StrawMan> straw_men(const Dataset& dataset, const Evidence& evidence) {
  return {best_equation(dataset, evidence, false), best_equation(dataset, evidence, true)};
}

}  // namespace biopsy::sim::gap
