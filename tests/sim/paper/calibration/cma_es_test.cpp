// The global search finds known minima, deterministically.
#include "sim/paper/calibration/cma_es.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim::calibration {
namespace {

using Vector = Eigen::VectorXd;

// An orthogonal matrix that mixes every direction with every other.
Eigen::MatrixXd rotation(int n) {
  Eigen::MatrixXd random(n, n);
  for (int i = 0; i < n * n; ++i) random(i / n, i % n) = normals(7, static_cast<std::uint64_t>(i)).first;
  return Eigen::HouseholderQR<Eigen::MatrixXd>(random).householderQ();
}

TEST(CmaEs, FindsTheMinimumOfARotatedEllipsoid) {
  constexpr int n = 8;
  const Eigen::MatrixXd turned = rotation(n);
  const Vector goal = Vector::LinSpaced(n, -1.0, 2.0);
  const auto cost = [&](const Vector& x) {
    const Vector y = turned * (x - goal);
    double sum = 0.0;
    for (int i = 0; i < n; ++i) sum += std::pow(1e4, i / (n - 1.0)) * y[i] * y[i];
    return sum;
  };
  const CmaResult found = minimise(cost, Vector::Zero(n), {.spread = 0.5, .evaluations = 8000});
  EXPECT_LT((found.best - goal).norm(), 1e-4);
  EXPECT_DOUBLE_EQ(found.value, cost(found.best));
}

TEST(CmaEs, MinimisesRosenbrock) {
  constexpr int n = 5;
  const auto cost = [](const Vector& x) {
    double sum = 0.0;
    for (int i = 0; i + 1 < n; ++i)
      sum += 100.0 * std::pow(x[i + 1] - x[i] * x[i], 2) + std::pow(1.0 - x[i], 2);
    return sum;
  };
  const CmaResult found = minimise(cost, Vector::Constant(n, -0.5), {.spread = 0.3, .evaluations = 12000});
  EXPECT_LT((found.best - Vector::Ones(n)).norm(), 1e-3);
}

TEST(CmaEs, LeavesLocalMinimaOfAFunnel) {
  const auto rastrigin = [](const Vector& x) {
    double sum = 0.0;
    for (const double xi : x) sum += xi * xi - 3.0 * std::cos(6.0 * xi) + 3.0;
    return sum;
  };
  const CmaResult found =
      minimise(rastrigin, Vector::Constant(4, 3.3), {.spread = 2.0, .population = 60, .evaluations = 12000});
  EXPECT_LT(found.best.norm(), 1e-3);
}

TEST(CmaEs, IsDeterministicForASeed) {
  const auto cost = [](const Vector& x) { return x.squaredNorm() + std::sin(9.0 * x.sum()); };
  const CmaSettings settings{.spread = 0.5, .evaluations = 300, .seed = 5};
  CmaSettings other = settings;
  other.seed = 6;
  const Vector start = Vector::Constant(6, 2.0);
  const CmaResult first = minimise(cost, start, settings), again = minimise(cost, start, settings);
  EXPECT_EQ(first.best, again.best);
  EXPECT_EQ(first.evaluations, again.evaluations);
  EXPECT_NE(first.best, minimise(cost, start, other).best);
}

TEST(CmaEs, TreatsNaNAsTheWorst) {
  const auto cost = [](const Vector& x) {
    return x[0] < 0.0 ? std::nan("") : (x - Vector::Ones(2)).squaredNorm();
  };
  const CmaResult found = minimise(cost, Vector::Constant(2, 0.2), {.spread = 0.5, .evaluations = 2000});
  EXPECT_LT((found.best - Vector::Ones(2)).norm(), 1e-4);
}

TEST(CmaEs, NeverReturnsAWorsePointThanItsStart) {
  const auto cost = [](const Vector& x) { return x.squaredNorm(); };
  const CmaResult found = minimise(cost, Vector::Zero(3), {.spread = 1.0, .evaluations = 40});
  EXPECT_EQ(found.value, 0.0);
  EXPECT_GE(found.evaluations, 40);
}

}  // namespace
}  // namespace biopsy::sim::calibration
