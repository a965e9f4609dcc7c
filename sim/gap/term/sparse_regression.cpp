#include "sim/gap/term/sparse_regression.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>

namespace biopsy::sim::gap {
namespace {

constexpr double kSparseRidge = 1e-8;    // of each diagonal element
constexpr std::size_t kSparseKept = 12;  // sets of one size that are grown

Eigen::VectorXd solve_scaled(Eigen::MatrixXd normal, const Eigen::VectorXd& right) {
  normal.diagonal() *= 1.0 + kSparseRidge;
  return normal.ldlt().solve(right);
}

}  // namespace

SparseRegression::SparseRegression(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target,
                                   std::size_t always, const Eigen::VectorXd& prior,
                                   const Eigen::VectorXd& about, const std::vector<int>& fold)
    : always_(always), scale_(Eigen::VectorXd::Ones(columns.cols())) {
  Eigen::MatrixXd scaled = columns;
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    const double norm = columns.col(c).norm();
    const bool good = std::isfinite(norm) && norm > 0.0;
    scale_[c] = good ? 1.0 / norm : 0.0;
    if (good)
      scaled.col(c) *= scale_[c];
    else
      scaled.col(c).setZero();
    if (const auto at = static_cast<std::size_t>(c); good && at >= always) usable_.push_back(at - always);
  }
  prior_ = prior_right_ = Eigen::VectorXd::Zero(columns.cols());
  for (Eigen::Index c = 0; c < prior.size(); ++c) {
    prior_[c] = scale_[c] > 0.0 ? prior[c] * scale_[c] * scale_[c] : 1.0;
    prior_right_[c] = prior[c] * scale_[c] * about[c];
  }
  const int folds = fold.empty() ? 0 : 1 + *std::ranges::max_element(fold);
  for (int f = 0; f < folds; ++f) {
    std::vector<Eigen::Index> rows;
    for (std::size_t i = 0; i < fold.size(); ++i)
      if (fold[i] == f) rows.push_back(static_cast<Eigen::Index>(i));
    if (rows.empty()) continue;
    const Eigen::MatrixXd A = scaled(rows, Eigen::all);
    const Eigen::VectorXd b = target(rows);
    folds_.push_back(
        {A.transpose() * A, A.transpose() * b, b.squaredNorm(), static_cast<double>(rows.size())});
  }
  all_ = {Eigen::MatrixXd::Zero(columns.cols(), columns.cols()), Eigen::VectorXd::Zero(columns.cols())};
  for (const Fold& one : folds_) {
    all_.normal += one.normal, all_.right += one.right;
    all_.square += one.square, all_.rows += one.rows;
  }
}

std::vector<Eigen::Index> SparseRegression::indices(const Support& support) const {
  std::vector<Eigen::Index> out;
  for (std::size_t i = 0; i < always_; ++i) out.push_back(static_cast<Eigen::Index>(i));
  for (const std::size_t column : support) out.push_back(static_cast<Eigen::Index>(always_ + column));
  return out;
}

double SparseRegression::cross_validated(const Support& support) const {
  const std::vector<Eigen::Index> at = indices(support);
  const Eigen::MatrixXd normal = all_.normal(at, at);
  const Eigen::VectorXd right = all_.right(at) + prior_right_(at), prior = prior_(at);
  double sum = 0.0;
  for (const Fold& fold : folds_) {
    const Eigen::MatrixXd own = fold.normal(at, at);
    const Eigen::VectorXd own_right = fold.right(at);
    Eigen::MatrixXd others = normal - own;
    others.diagonal() += prior;
    const Eigen::VectorXd c = solve_scaled(std::move(others), right - own_right);
    sum += fold.square - 2.0 * c.dot(own_right) + c.dot(own * c);
  }
  return sum / all_.rows;
}

Eigen::VectorXd SparseRegression::solve(const Support& support) const {
  const std::vector<Eigen::Index> at = indices(support);
  Eigen::MatrixXd normal = all_.normal(at, at);
  normal.diagonal() += prior_(at);
  const Eigen::VectorXd scale = scale_(at);
  return solve_scaled(std::move(normal), all_.right(at) + prior_right_(at)).cwiseProduct(scale);
}

std::vector<std::vector<ScoredSupport>> SparseRegression::search(
    std::size_t most, const std::function<bool(const Support&, std::size_t)>& fits) const {
  std::vector<std::vector<ScoredSupport>> out;
  std::vector<ScoredSupport> last{{{}, 0.0}};
  for (std::size_t size = 1; size <= most; ++size) {
    std::set<Support> seen;
    std::vector<ScoredSupport> grown;
    for (const ScoredSupport& from : last)
      for (const std::size_t column : usable_) {
        if (std::ranges::find(from.columns, column) != from.columns.end() || !fits(from.columns, column))
          continue;
        Support next = from.columns;
        next.insert(std::ranges::upper_bound(next, column), column);
        if (!seen.insert(next).second) continue;
        const double square = cross_validated(next);
        if (std::isfinite(square)) grown.push_back({std::move(next), square});
      }
    std::ranges::stable_sort(grown, {}, &ScoredSupport::square);
    if (grown.size() > kSparseKept) grown.resize(kSparseKept);
    if (grown.empty()) break;
    out.push_back(grown);
    last = std::move(grown);
  }
  return out;
}

}  // namespace biopsy::sim::gap
