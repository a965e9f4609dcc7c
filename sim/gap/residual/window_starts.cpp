#include "sim/gap/residual/window_starts.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace biopsy::sim::gap {
namespace {

constexpr double kFollows = 1.5;        // of the noise
constexpr double kAtThisManyOf = 0.75;  // moments
constexpr double kWider = 1.4;
constexpr double kStandstill = 3.0;  // standard deviations of the speed
constexpr std::size_t kNarrowest = 2;
constexpr Eigen::Index kTerms = 4;

struct LocalCubic {
  double x = 0.0, v = 0.0;
  double scatter = 0.0;      // m, of the readings around it
  double v_per_noise = 0.0;  // 1/s, standard deviation of v for readings of unit noise
};

LocalCubic local_cubic(const RecordedRun& run, std::size_t row, std::size_t half) {
  const std::size_t from = row > half ? row - half : 0, to = std::min(run.time.size(), row + half + 1);
  const auto n = static_cast<Eigen::Index>(to - from);
  const double width = static_cast<double>(half) * run.period;
  Eigen::MatrixXd A(n, kTerms);
  Eigen::VectorXd y(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t at = from + static_cast<std::size_t>(i);
    const double t = (run.time[at] - run.time[row]) / width;
    A.row(i) << 1.0, t, t * t, t * t * t;
    y[i] = run.displacement[at];
  }
  if (n < kTerms) return {.x = run.displacement[row]};
  const Eigen::MatrixXd solve = A.completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::VectorXd c = solve * y;
  const double freedom = std::max<double>(1.0, static_cast<double>(n - kTerms));
  return {c[0], c[1] / width, (y - A * c).norm() / std::sqrt(freedom), solve.row(1).norm() / width};
}

std::vector<LocalCubic> at_each(const RecordedRun& run, const std::vector<std::size_t>& rows,
                                std::size_t half) {
  std::vector<LocalCubic> out;
  out.reserve(rows.size());
  for (const std::size_t row : rows) out.push_back(local_cubic(run, row, half));
  return out;
}

bool follows(const std::vector<LocalCubic>& fits, double noise) {
  const auto good = std::count_if(fits.begin(), fits.end(),
                                  [&](const LocalCubic& fit) { return fit.scatter <= kFollows * noise; });
  return static_cast<double>(good) >= kAtThisManyOf * static_cast<double>(fits.size());
}

}  // namespace

std::vector<StartMotion> window_starts(const RecordedRun& run, const std::vector<std::size_t>& rows,
                                       double noise) {
  const std::size_t apart = rows.size() > 1 ? rows[1] - rows[0] : run.time.size();
  std::vector<LocalCubic> best = at_each(run, rows, kNarrowest);
  for (double half = kNarrowest * kWider; half <= static_cast<double>(apart) / 4.0; half *= kWider) {
    std::vector<LocalCubic> wider = at_each(run, rows, static_cast<std::size_t>(std::lround(half)));
    if (follows(wider, noise)) best = std::move(wider);
  }
  std::vector<StartMotion> out;
  out.reserve(best.size());
  for (const LocalCubic& fit : best)
    out.push_back({fit.x, std::abs(fit.v) < kStandstill * noise * fit.v_per_noise ? 0.0 : fit.v});
  return out;
}

}  // namespace biopsy::sim::gap
