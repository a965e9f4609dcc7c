#include "sim/paper/calibration/cma_es.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "robot/common/in_parallel.hpp"
#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim::calibration {
namespace {

// Constants of the tutorial's table 1, positive weights only.
struct Rates {
  Eigen::VectorXd weights;
  double mu_eff, c_sigma, d_sigma, c_c, c_1, c_mu, chi;

  Rates(double n, int population) {
    const int parents = population / 2;
    weights.resize(parents);
    for (int i = 0; i < parents; ++i) weights[i] = std::log(0.5 * (population + 1.0)) - std::log(i + 1.0);
    weights /= weights.sum();
    mu_eff = 1.0 / weights.squaredNorm();
    c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
    d_sigma = 1.0 + 2.0 * std::max(0.0, std::sqrt((mu_eff - 1.0) / (n + 1.0)) - 1.0) + c_sigma;
    c_c = (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n);
    c_1 = 2.0 / ((n + 1.3) * (n + 1.3) + mu_eff);
    c_mu = std::min(1.0 - c_1, 2.0 * (mu_eff - 2.0 + 1.0 / mu_eff) / ((n + 2.0) * (n + 2.0) + mu_eff));
    chi = std::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
  }
};

// The adapted normal distribution.
class SearchDistribution {
 public:
  SearchDistribution(const Eigen::VectorXd& start, const CmaSettings& settings, int population)
      : n_(start.size()),
        rates_(static_cast<double>(n_), population),
        seed_(settings.seed),
        mean_(start),
        sigma_(settings.spread),
        covariance_(Eigen::MatrixXd::Identity(n_, n_)),
        axes_(covariance_),
        lengths_(Eigen::VectorXd::Ones(n_)),
        path_sigma_(Eigen::VectorXd::Zero(n_)),
        path_c_(Eigen::VectorXd::Zero(n_)) {}

  Eigen::VectorXd drawn() {
    Eigen::VectorXd z(n_);
    for (double& value : z) value = normals(seed_, drawn_++).first;
    return mean_ + sigma_ * (axes_ * lengths_.cwiseProduct(z));
  }

  // `ranked`: the generation, best first.
  void adapt(const std::vector<Eigen::VectorXd>& ranked) {
    ++generation_;
    const Rates& r = rates_;
    const Eigen::VectorXd before = mean_;
    mean_.setZero();
    for (Eigen::Index i = 0; i < r.weights.size(); ++i) mean_ += r.weights[i] * ranked[i];
    const Eigen::VectorXd shift = (mean_ - before) / sigma_;
    const Eigen::VectorXd white = axes_ * (axes_.transpose() * shift).cwiseQuotient(lengths_);
    path_sigma_ =
        (1.0 - r.c_sigma) * path_sigma_ + std::sqrt(r.c_sigma * (2.0 - r.c_sigma) * r.mu_eff) * white;
    const double grown = path_sigma_.norm() / std::sqrt(1.0 - std::pow(1.0 - r.c_sigma, 2.0 * generation_));
    const bool moves = grown < (1.4 + 2.0 / (static_cast<double>(n_) + 1.0)) * r.chi;
    path_c_ *= 1.0 - r.c_c;
    if (moves) path_c_ += std::sqrt(r.c_c * (2.0 - r.c_c) * r.mu_eff) * shift;
    adapt_covariance(ranked, before, moves);
    sigma_ *= std::exp(r.c_sigma / r.d_sigma * (path_sigma_.norm() / r.chi - 1.0));
  }

  double widest() const { return sigma_ * lengths_.maxCoeff(); }

 private:
  void adapt_covariance(const std::vector<Eigen::VectorXd>& ranked, const Eigen::VectorXd& before,
                        bool moves) {
    const Rates& r = rates_;
    const double stalled = moves ? 0.0 : r.c_c * (2.0 - r.c_c);
    covariance_ *= 1.0 - r.c_1 - r.c_mu + r.c_1 * stalled;
    covariance_ += r.c_1 * path_c_ * path_c_.transpose();
    for (Eigen::Index i = 0; i < r.weights.size(); ++i) {
      const Eigen::VectorXd y = (ranked[i] - before) / sigma_;
      covariance_ += r.c_mu * r.weights[i] * y * y.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance_);
    axes_ = eigen.eigenvectors();
    lengths_ = eigen.eigenvalues().cwiseMax(1e-20).cwiseSqrt();
  }

  Eigen::Index n_;
  Rates rates_;
  std::uint64_t seed_, drawn_ = 0;
  double generation_ = 0.0;
  Eigen::VectorXd mean_;
  double sigma_;
  Eigen::MatrixXd covariance_, axes_;
  Eigen::VectorXd lengths_, path_sigma_, path_c_;
};

double finite(double value) {
  return std::isfinite(value) ? value : std::numeric_limits<double>::max();
}

}  // namespace

CmaResult minimise(const Cost& cost, const Eigen::VectorXd& start, const CmaSettings& settings,
                   const CmaProgress& progress) {
  const auto n = static_cast<double>(start.size());
  const int population =
      settings.population > 1 ? settings.population : 4 + static_cast<int>(3.0 * std::log(n));
  SearchDistribution distribution(start, settings, population);
  CmaResult out{start, finite(cost(start)), 1};
  std::vector<Eigen::VectorXd> points(population);
  std::vector<double> values(population);
  while (out.evaluations < settings.evaluations && distribution.widest() > settings.narrow) {
    for (Eigen::VectorXd& point : points) point = distribution.drawn();
    in_parallel(points.size(), [&](std::size_t i) {
      if (!settings.stop.stop_requested()) values[i] = finite(cost(points[i]));
    });
    if (settings.stop.stop_requested()) break;
    out.evaluations += population;
    std::vector<std::size_t> order(population);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return values[a] < values[b]; });
    std::vector<Eigen::VectorXd> ranked;
    ranked.reserve(population);
    for (const std::size_t i : order) ranked.push_back(points[i]);
    if (values[order[0]] < out.value) {
      out.value = values[order[0]];
      out.best = ranked[0];
    }
    distribution.adapt(ranked);
    if (progress) progress(static_cast<double>(out.evaluations) / settings.evaluations, out.value);
  }
  return out;
}

}  // namespace biopsy::sim::calibration
