// Which few of many columns explain a residual: least squares for every small set of columns, judged on rows
// that the set was not fitted to.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

namespace biopsy::sim::gap {

using Support = std::vector<std::size_t>;  // of candidate columns, ascending

struct ScoredSupport {
  Support columns;
  double square = 0.0;  // mean square of rows that it was not fitted to
};

class SparseRegression {
 public:
  // Columns before `always` belong to every fit; `prior` adds to the diagonal of their normal equations,
  // about these values of the solution. `fold` of each row: rows of one fold are predicted from the others;
  // negative: not used.
  SparseRegression(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, std::size_t always,
                   const Eigen::VectorXd& prior, const Eigen::VectorXd& about, const std::vector<int>& fold);

  // The best sets of 1, 2, ... `most` candidates, each list best first; grown from the best of one less.
  // `fits`: whether a candidate may join a set.
  std::vector<std::vector<ScoredSupport>> search(
      std::size_t most, const std::function<bool(const Support&, std::size_t)>& fits) const;

  double cross_validated(const Support& support) const;
  // Of the always columns and of the support's, fitted to all folds.
  Eigen::VectorXd solve(const Support& support) const;

 private:
  struct Fold {
    Eigen::MatrixXd normal;
    Eigen::VectorXd right;
    double square = 0.0, rows = 0.0;
  };
  std::vector<Eigen::Index> indices(const Support& support) const;

  std::size_t always_;
  std::vector<std::size_t> usable_;  // candidates that are finite and not zero
  Eigen::VectorXd scale_, prior_, prior_right_;
  std::vector<Fold> folds_;
  Fold all_;
};

}  // namespace biopsy::sim::gap
