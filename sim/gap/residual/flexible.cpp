#include "sim/gap/residual/flexible.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "robot/common/in_parallel.hpp"
#include "robot/common/statistics.hpp"
#include "sim/gap/fit/fit.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/residual/responses.hpp"
#include "sim/gap/residual/smoothed_motion.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr std::size_t kDegree = 3;
constexpr double kOutermost = 0.01;  // of the rows, at either end
constexpr double kRidge = 1e-8;      // of the largest diagonal element

// The variable at every row of all runs.
struct Variable {
  std::string name;
  std::vector<double> values;
};

std::vector<Variable> variables_of(const Evidence& evidence) {
  std::vector<Variable> out{{"speed", {}}, {"position", {}}, {"input", {}}, {"time", {}}};
  for (const EvidenceRun& run : evidence.runs) {
    std::vector<double> readings;
    for (const Row& row : run.rows) readings.push_back(row.measured);
    const SmoothedMotion motion = smoothed_motion(run, readings, evidence.noise);
    for (std::size_t i = 0; i < run.rows.size(); ++i) {
      out[0].values.push_back(motion.v[i]);
      out[1].values.push_back(motion.x[i]);
      out[2].values.push_back(run.rows[i].input);
      out[3].values.push_back(run.rows[i].time);
    }
  }
  return out;
}

// Where a variable lies between all but its outermost readings, -1 to 1; beyond them the ends.
std::vector<double> normalised(const std::vector<double>& values) {
  const double low = quantile(values, kOutermost), high = quantile(values, 1.0 - kOutermost);
  std::vector<double> out;
  if (high <= low) return out;
  for (const double value : values)
    out.push_back(std::clamp(2.0 * (value - low) / (high - low) - 1.0, -1.0, 1.0));
  return out;
}

// Legendre's polynomial of degree n: by Bonnet's recursion.
double legendre(std::size_t n, double at) {
  double before = 1.0, now = at;
  if (n == 0) return before;
  for (std::size_t k = 1; k < n; ++k) {
    const auto m = static_cast<double>(k);
    before = std::exchange(now, ((2.0 * m + 1.0) * at * now - m * before) / (m + 1.0));
  }
  return now;
}

std::vector<bool> training_mask(const Evidence& evidence) {
  std::vector<bool> out;
  for (const EvidenceRun& run : evidence.runs)
    for (std::size_t i = 0; i < run.rows.size(); ++i) out.push_back(i < run.training_rows);
  return out;
}

// Mean square of the held-out rows with the columns of J fitted to the training rows; columns before `known`
// have priors of one.
double held_out_square(const Eigen::MatrixXd& J, const Eigen::VectorXd& r, const std::vector<bool>& training,
                       const Eigen::VectorXd& prior) {
  Eigen::MatrixXd A = J;
  Eigen::VectorXd b = r;
  for (Eigen::Index i = 0; i < r.size(); ++i)
    if (!training[static_cast<std::size_t>(i)]) A.row(i).setZero(), b[i] = 0.0;
  Eigen::MatrixXd normal = A.transpose() * A;
  normal.diagonal() += prior;
  // Columns differ in size by orders of magnitude: a ridge each, of its own.
  normal.diagonal() *= 1.0 + kRidge;
  const Eigen::VectorXd fitted = normal.ldlt().solve(A.transpose() * b);
  const Eigen::VectorXd left = r - J * fitted;
  double sum = 0.0, rows = 0.0;
  for (Eigen::Index i = 0; i < r.size(); ++i)
    if (!training[static_cast<std::size_t>(i)]) sum += left[i] * left[i], rows += 1.0;
  return rows > 0.0 ? sum / rows : 0.0;
}

}  // namespace

std::vector<FlexibleFit> fit_flexible(const ScoredModel& start, const Evidence& evidence, bool numbers) {
  const Responses responses(start.hypothesis, evidence);
  const Eigen::VectorXd now = responses.now();
  const std::vector<Variable> variables = variables_of(evidence);
  const std::vector<bool> training = training_mask(evidence);
  const auto unknowns = start.hypothesis.unknowns.size();
  struct Task {
    std::size_t variable = 0;
    std::vector<double> shape = {};
    Eigen::VectorXd response = {};
  };
  std::vector<Task> tasks(unknowns);
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const std::vector<double> places = normalised(variables[v].values);
    for (std::size_t n = 0; n <= kDegree && !places.empty(); ++n) {
      tasks.push_back({.variable = v});
      for (const double at : places) tasks.back().shape.push_back(legendre(n, at));
    }
  }
  in_parallel(tasks.size(), [&](std::size_t t) {
    tasks[t].response = t < unknowns ? responses.of_unknown(t) : responses.of_force(tasks[t].shape);
  });
  const double weight = residual_weight(evidence, now.squaredNorm() / static_cast<double>(now.size()));
  std::vector<FlexibleFit> out;
  const auto add = [&](const std::string& acts, std::size_t variable, const auto& column_of_task) {
    std::vector<Eigen::VectorXd> columns;
    for (std::size_t t = 0; t < tasks.size(); ++t) {
      if (t < unknowns)
        columns.push_back(tasks[t].response);
      else if (tasks[t].variable == variable)
        columns.push_back(column_of_task(tasks[t]));
    }
    if (columns.size() <= unknowns) return;
    Eigen::MatrixXd J(now.size(), static_cast<Eigen::Index>(columns.size()));
    Eigen::VectorXd prior = Eigen::VectorXd::Zero(J.cols());
    for (std::size_t c = 0; c < columns.size(); ++c) {
      J.col(static_cast<Eigen::Index>(c)) = columns[c];
      if (c < unknowns && std::isfinite(start.hypothesis.unknowns[c].prior_std))
        prior[static_cast<Eigen::Index>(c)] =
            1.0 / (weight * std::pow(start.hypothesis.unknowns[c].prior_std, 2));
    }
    if (J.allFinite())
      out.push_back({acts, variables[variable].name, held_out_square(J, now, training, prior)});
  };
  for (std::size_t v = 0; v < variables.size(); ++v) {
    add("force", v, [](const Task& task) { return task.response; });
    add("reading", v, [](const Task& task) { return column_of(task.shape); });
    for (std::size_t t = 0; numbers && t < unknowns; ++t) {
      const Unknown& number = start.hypothesis.unknowns[t];
      if (number.effect != kBaseline) continue;
      const auto name = uncertain_baseline(start.drive())[number.parameter].name;
      add(std::string(name), v, [&](const Task& task) -> Eigen::VectorXd {
        return tasks[t].response.cwiseProduct(column_of(task.shape));
      });
    }
  }
  std::ranges::stable_sort(out, {}, &FlexibleFit::square);
  return out;
}

}  // namespace biopsy::sim::gap
