#include "sim/gap/window_start.hpp"

#include <Eigen/QR>
#include <algorithm>

namespace biopsy::sim::gap {
namespace {

constexpr double kHalfWidth = 0.02;  // s
constexpr std::size_t kFewest = 4;

}  // namespace

Motion2 window_start(const RecordedRun& run, std::size_t row, double) {
  const auto half = std::max(kFewest, static_cast<std::size_t>(kHalfWidth / run.period));
  const std::size_t from = row > half ? row - half : 0;
  const std::size_t to = std::min(run.time.size(), row + half + 1);
  const auto n = static_cast<Eigen::Index>(to - from);
  Eigen::MatrixXd A(n, 4);
  Eigen::VectorXd y(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t at = from + static_cast<std::size_t>(i);
    const double t = (run.time[at] - run.time[row]) / kHalfWidth;
    A.row(i) << 1.0, t, t * t, t * t * t;
    y[i] = run.displacement[at];
  }
  const Eigen::VectorXd c = A.householderQr().solve(y);
  return {c[0], c[1] / kHalfWidth};
}

}  // namespace biopsy::sim::gap
