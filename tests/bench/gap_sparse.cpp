#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <numeric>

#include "sim/gap/fit/library.hpp"
#include "sim/gap/select/evidence_runs.hpp"
#include "tests/bench/gap_balance.hpp"
#include "tests/bench/gap_peers.hpp"

namespace biopsy::bench {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

constexpr int kThresholdRounds = 10;
constexpr double kThresholds[] = {0.05, 0.1, 0.2, 0.3, 0.5};  // a term's share of the whole, root mean square
constexpr double kRidge = 0.05;                               // PySINDy's
constexpr double kAboutAsGood = 1.05;  // of the least held-out error: the sparsest within it is taken

double strongest_frequency(const Balance& b) {
  double best = 0.25, most = 0.0;
  for (double f = 0.05; f < 2.0; f += 0.01) {
    std::complex<double> sum = 0.0;
    for (Eigen::Index i = 0; i < b.time.size(); ++i)
      sum += b.left_over(i) * std::polar(1.0, 2 * std::numbers::pi * f * b.time(i));
    if (std::norm(sum) > most) most = std::norm(sum), best = f;
  }
  return best;
}

// A column each, of length 1. Ridge regression of the kept ones while some are still to go (otherwise two
// that are nearly alike cancel each other at any size), plain at the end, so that what stays is not shrunk.
VectorXd regressed(const MatrixXd& scaled, const VectorXd& target, const std::vector<Eigen::Index>& kept,
                   double ridge) {
  const MatrixXd used = scaled(Eigen::all, kept);
  const MatrixXd normal = used.transpose() * used + ridge * MatrixXd::Identity(used.cols(), used.cols());
  const VectorXd part = normal.ldlt().solve(used.transpose() * target);
  VectorXd out = VectorXd::Zero(scaled.cols());
  for (std::size_t i = 0; i < kept.size(); ++i) out(kept[i]) = part(static_cast<Eigen::Index>(i));
  return out;
}

// Terms whose part of the force stays above `threshold` of the whole; the others are 0.
VectorXd thresholded(const Balance& b, double threshold) {
  const VectorXd size = (b.columns.colwise().norm().array() + 1e-30).matrix().transpose();
  const MatrixXd scaled = b.columns * size.cwiseInverse().asDiagonal();
  std::vector<Eigen::Index> kept(static_cast<std::size_t>(b.columns.cols()));
  std::iota(kept.begin(), kept.end(), 0);
  for (int round = 0; round < kThresholdRounds && !kept.empty(); ++round) {
    const VectorXd part = regressed(scaled, b.left_over, kept, kRidge);
    const double least = threshold * b.left_over.norm();
    if (std::erase_if(kept, [&](Eigen::Index i) { return std::abs(part(i)) < least; }) == 0) break;
  }
  if (kept.empty()) return VectorXd::Zero(b.columns.cols());
  return regressed(scaled, b.left_over, kept, 0.0).cwiseQuotient(size);
}

// The sparsest that predicts the held-out runs about as well as the best.
VectorXd sparse_coefficients(const Balance& training, const Balance& held_out) {
  std::vector<std::pair<double, VectorXd>> tried{
      {held_out.left_over.norm(), VectorXd::Zero(training.columns.cols())}};
  for (const double threshold : kThresholds) {
    const VectorXd c = thresholded(training, threshold);
    tried.emplace_back((held_out.left_over - held_out.columns * c).norm(), c);
  }
  const double least = std::ranges::min_element(tried, {}, &std::pair<double, VectorXd>::first)->first;
  const auto terms = [](const VectorXd& c) { return (c.array() != 0.0).count(); };
  VectorXd best;
  for (const auto& [error, c] : tried)
    if (error <= kAboutAsGood * least && (best.size() == 0 || terms(c) < terms(best))) best = c;
  return best;
}

struct Survivor {
  Column column;
  double part = 0.0, coefficient = 0.0, std = 0.0;  // part: of the left-over force
};

std::vector<Survivor> survivors(const Balance& b, const VectorXd& c, const std::vector<Column>& columns) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < c.size(); ++i)
    if (c(i) != 0.0) kept.push_back(i);
  std::vector<Survivor> out;
  if (kept.empty()) return out;
  const MatrixXd used = b.columns(Eigen::all, kept);
  const double scatter =
      (b.left_over - b.columns * c).squaredNorm() / static_cast<double>(b.left_over.size());
  const MatrixXd covariance =
      scatter * (used.transpose() * used).ldlt().solve(MatrixXd::Identity(used.cols(), used.cols()));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    out.push_back({columns[static_cast<std::size_t>(kept[i])],
                   b.columns.col(kept[i]).norm() * std::abs(c(kept[i])), c(kept[i]),
                   std::sqrt(std::max(0.0, covariance(at, at)))});
  }
  std::ranges::sort(out, std::greater{}, &Survivor::part);
  return out;
}

bool is_baseline(const Column& column) {
  return column.effect == "K" || column.effect == "k" || column.effect == "c_s";
}

void put_in(sim::PlantModel& model, const Survivor& one) {
  const Column& column = one.column;
  if (column.effect == "k") model.baseline.k = std::max(1.0, model.baseline.k + one.coefficient);
  if (column.effect == "c_s") model.baseline.c_s = std::max(0.0, model.baseline.c_s - one.coefficient);
  if (column.effect == "periodic_disturbance") return;  // of two columns, without a phase
  for (const auto& effect : sim::gap::library()) {
    if (effect.info.name != column.effect) continue;
    for (std::size_t i = 0; i < effect.parameters.size(); ++i)
      if (const auto& p = effect.parameters[i]; p.name == column.parameter) {
        if (!effect.present(model)) effect.add(model);
        effect.set(model, i, std::clamp(one.coefficient * column.in_file * p.si_per_unit, p.low, p.high));
      }
  }
}

// The model with those terms in it that are one number of the library; the others cannot be simulated.
sim::PlantModel with_terms(sim::PlantModel model, const std::vector<Survivor>& found) {
  for (const Survivor& one : found) put_in(model, one);
  return model;
}

void name(hidden::Answer& answer, const std::vector<Survivor>& found) {
  for (const Survivor& one : found) {
    const Column& column = one.column;
    if (is_baseline(column)) {
      answer.parameters_changed.push_back(column.effect);
      continue;
    }
    if (std::ranges::find(answer.effects, column.effect, &hidden::AnsweredEffect::name) !=
        answer.effects.end())
      continue;
    answer.effects.push_back({column.effect, 1.0, {}, {}});
    if (!column.parameter.empty() && column.effect != "periodic_disturbance")
      answer.effects.back().parameters.push_back(
          {column.parameter, one.coefficient * column.in_file, one.std * std::abs(column.in_file)});
  }
  answer.verdict = !answer.effects.empty()              ? "effect"
                   : !answer.parameters_changed.empty() ? "parameter"
                                                        : "no_gap";
}

}  // namespace

hidden::Answer regress_sparsely(const sim::Dataset& data, const sim::PlantModel& model) {
  const auto evidence = sim::gap::prepare(data, model, {}, sim::gap::Sampling::Fine);
  std::vector<SampledRun> training, held_out;
  for (std::size_t i = 0; i < data.runs.size(); ++i)
    (evidence.runs[i].training_rows > 0 ? training : held_out).push_back(sampled(data.runs[i], model));
  if (held_out.empty()) held_out = training;
  const sim::Baseline& baseline = model.baseline;
  const auto columns = dictionary(baseline, strongest_frequency(balance(training, {}, baseline)));
  const Balance trained = balance(training, columns, baseline);
  const VectorXd c = sparse_coefficients(trained, balance(held_out, columns, baseline));
  const auto found = survivors(trained, c, columns);
  hidden::Answer answer;
  name(answer, found);
  mark(answer, model, with_terms(model, found), evidence);
  return answer;
}

}  // namespace biopsy::bench
