#include "planner/imaging/depth_check/tip_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core/optim.hpp>

namespace biopsy::imaging {
namespace {

constexpr double kReach_mm = 10.0;  // of the shaft that is fitted with the tip
constexpr double kBeyond_mm = 8.0;  // of the tissue ahead of it
constexpr std::size_t kVoxelsMax = 4000;
constexpr double kStartsApart_mm = 2.0;
constexpr double kNearlyAsWell = 40.0;  // chi-square: five standard deviations with the doubt about its scale
constexpr std::array<double, 3> kRounding{0.0, 0.5, 1.0};  // flat end, half way, half a sphere

// The void near its tip: fades over `soft` at its side and its end.
struct VoidShape {
  VoidLine line;
  double depth = 0.0, soft = 0.4, rounding = 0.5;
};

struct Sums {
  double match = 0.0, energy = 0.0, change = 0.0;

  double loss() const { return energy > 0.0 ? std::clamp(match / energy, 0.0, 1.1) : 0.0; }
  double chi2() const { return change - loss() * (2.0 * match - loss() * energy); }
};

double ramp(double x, double soft) {
  return std::clamp(0.5 + 0.5 * x / soft, 0.0, 1.0);
}

class LocalVoxels {
 public:
  // Voxels whose centre lies within `reach_mm` of the line.
  LocalVoxels(const Corridor& corridor, const VoidLine& line, double depth, double reach_mm)
      : corridor_(corridor) {
    for (const CorridorVoxel& one : corridor.voxels) {
      const double t = static_cast<double>(one.t);
      if (t < depth - kReach_mm || t > depth + kBeyond_mm) continue;
      if (std::hypot(static_cast<double>(one.u) - line.u - line.u_slope * t,
                     static_cast<double>(one.v) - line.v - line.v_slope * t) <= reach_mm)
        voxels_.push_back(one);
    }
    // Fine voxels by the ten thousand say no more about a depth than some thousand of them do.
    const std::size_t every = voxels_.size() / kVoxelsMax + 1;
    std::size_t kept = 0;
    for (std::size_t n = 0; n < voxels_.size(); n += every) voxels_[kept++] = voxels_[n];
    voxels_.resize(kept);
  }

  std::size_t size() const { return voxels_.size(); }

  Sums sums(const VoidShape& shape) const {
    Sums sums;
    for (const CorridorVoxel& voxel : voxels_) {
      const double predicted = static_cast<double>(voxel.predicted),
                   variance = static_cast<double>(voxel.variance);
      const double change = predicted - static_cast<double>(voxel.measured);
      sums.change += change * change / variance;
      const double covered = coverage(voxel, shape);
      if (covered <= 0.0) continue;
      const double expected = predicted * covered;
      sums.match += expected * change / variance;
      sums.energy += expected * expected / variance;
    }
    return sums;
  }

 private:
  double coverage(const CorridorVoxel& voxel, const VoidShape& shape) const {
    double sum = 0.0;
    for (const Eigen::Vector3d& place : corridor_.places) {
      const double t = static_cast<double>(voxel.t) + place.x();
      if (t > shape.depth + shape.soft) continue;
      const double u = static_cast<double>(voxel.u) + place.y() - shape.line.u - shape.line.u_slope * t;
      const double v = static_cast<double>(voxel.v) + place.z() - shape.line.v - shape.line.v_slope * t;
      const double radius = shape.line.radius_mm, from_axis = std::sqrt(u * u + v * v);
      if (from_axis > radius + shape.soft) continue;
      const double rim = std::min(from_axis / radius, 1.0);
      const double end = shape.depth - shape.rounding * radius * (1.0 - std::sqrt(1.0 - rim * rim));
      sum += ramp(radius - from_axis, shape.soft) * ramp(end - t, shape.soft);
    }
    return sum / static_cast<double>(corridor_.places.size());
  }

  const Corridor& corridor_;
  std::vector<CorridorVoxel> voxels_;
};

// Depth, width, softness and deviation that explain the voxels best, for one rounding.
class ShapeCost : public cv::MinProblemSolver::Function {
 public:
  ShapeCost(const LocalVoxels& voxels, const VoidShape& start) : voxels_(voxels), start_(start) {}

  int getDims() const override { return 5; }
  double calc(const double* x) const override {
    const double stray = std::max(std::abs(x[3]) - 1.5, 0.0) + std::max(std::abs(x[4]) - 1.5, 0.0) +
                         std::max(std::abs(x[1]) - 1.2, 0.0) + std::max(std::abs(x[2]) - 1.2, 0.0);
    return voxels_.sums(shape(x)).chi2() + 1e4 * stray;
  }
  VoidShape shape(const double* x) const {
    VoidShape shape = start_;
    shape.depth += x[0];
    shape.line.radius_mm *= std::exp(std::clamp(x[1], -1.2, 1.2));
    shape.soft *= std::exp(std::clamp(x[2], -1.2, 1.2));
    shape.line.u += x[3];
    shape.line.v += x[4];
    return shape;
  }

 private:
  const LocalVoxels& voxels_;
  VoidShape start_;
};

VoidShape best_shape(const LocalVoxels& voxels, VoidShape start) {
  VoidShape best = start;
  double least = voxels.sums(best).chi2();
  for (double rounding : kRounding) {
    start.rounding = rounding;
    const auto cost = cv::makePtr<ShapeCost>(voxels, start);
    cv::Mat x = cv::Mat::zeros(1, 5, CV_64F);
    const cv::Mat step = (cv::Mat_<double>(1, 5) << 1.0, 0.3, 0.3, 0.4, 0.4);
    const auto solver = cv::DownhillSolver::create(
        cost, step, cv::TermCriteria(cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, 160, 1e-3));
    solver->minimize(x);
    const VoidShape shape = cost->shape(x.ptr<double>());
    const double chi2 = voxels.sums(shape).chi2();
    if (chi2 < least) least = chi2, best = shape;
  }
  return best;
}

// Mean and spread of the depth's likelihood about the best shape; how the void's end is rounded and how it
// fades are left open.
void spread_of_depth(const LocalVoxels& voxels, const VoidShape& best, double widening, TipFit& fit) {
  constexpr double kStep_mm = 0.1, kSpan_mm = 6.0;
  std::vector<double> depths, chi2;
  for (double offset = -kSpan_mm; offset <= kSpan_mm; offset += kStep_mm) {
    double least = 1e300;
    VoidShape shape = best;
    shape.depth = best.depth + offset;
    for (double rounding : kRounding)
      for (double fade : {0.6, 1.0, 1.7}) {
        shape.rounding = rounding;
        shape.soft = fade * best.soft;
        least = std::min(least, voxels.sums(shape).chi2());
      }
    depths.push_back(shape.depth);
    chi2.push_back(least);
  }
  const double least = *std::min_element(chi2.begin(), chi2.end());
  double total = 0.0, first = 0.0, second = 0.0;
  for (std::size_t n = 0; n < depths.size(); ++n) {
    const double weight = std::exp(-0.5 * (chi2[n] - least) / widening), offset = depths[n] - best.depth;
    total += weight, first += weight * offset, second += weight * offset * offset;
  }
  const double mean = first / total;
  fit.depth_mm = best.depth + mean;
  fit.sigma_mm = std::sqrt(std::max(second / total - mean * mean, 0.0));
}

// Depths that explain the voxels less well than the best by no more than `chance` standard deviations.
void range_of_depth(const LocalVoxels& voxels, const VoidShape& best, double chance, TipFit& fit) {
  constexpr double kStep_mm = 0.2, kSpan_mm = 5.0;
  const auto least_at = [&](double depth) {
    double least = 1e300;
    VoidShape shape = best;
    shape.depth = depth;
    for (double rounding : kRounding)
      shape.rounding = rounding, least = std::min(least, voxels.sums(shape).chi2());
    return least;
  };
  const double limit = voxels.sums(best).chi2() + chance * chance;
  fit.low_mm = std::min(best.depth, fit.depth_mm), fit.high_mm = std::max(best.depth, fit.depth_mm);
  for (double offset = kStep_mm; offset <= kSpan_mm; offset += kStep_mm) {
    if (least_at(best.depth - offset) < limit) fit.low_mm = std::min(fit.low_mm, best.depth - offset);
    if (least_at(best.depth + offset) < limit) fit.high_mm = std::max(fit.high_mm, best.depth + offset);
  }
}

// Shape and depth from one start.
TipFit fit_from(const Corridor& corridor, const LocalVoxels& voxels, const VoidShape& start, double voxel_mm,
                double chance) {
  const VoidShape best = best_shape(voxels, start);
  const Sums sums = voxels.sums(best);
  TipFit fit;
  fit.line = best.line;
  fit.loss = sums.loss();
  fit.chi2 = sums.chi2();
  fit.misfit = fit.chi2 / std::max(static_cast<double>(voxels.size()) - 6.0, 1.0);
  // What is left over is alike in neighbouring voxels (interpolation, motion): fewer independent ones than
  // counted.
  constexpr double kAlike = 1.3;
  // The depth is that of the centreline: a wide void's rim, whose form is unknown, has no say in it.
  const LocalVoxels core(corridor, best.line, best.depth, 0.5 * best.line.radius_mm + 0.35 + voxel_mm);
  spread_of_depth(core, best, kAlike * std::max(fit.misfit, 0.5), fit);
  // Below this the shape of the void's end, not noise, is the limit.
  const double model = 0.02 + 0.04 * corridor.along_mm, end_form = 0.04 * best.line.radius_mm;
  fit.sigma_mm = std::hypot(fit.sigma_mm, model, end_form);
  range_of_depth(voxels, best, chance, fit);
  // Chance reaches about 4.5 in the search beside the path; where it reached more, all errors are larger
  // alike.
  fit.sigma_mm = std::max(fit.sigma_mm, 0.5 * (fit.high_mm - fit.low_mm) / 4.5);
  return fit;
}

}  // namespace

TipFit fit_tip(const Corridor& corridor, const VoidLine& line, double depth_mm, double chance) {
  double voxel = 0.0;
  for (const Eigen::Vector2d& place : corridor.lateral) voxel = std::max(voxel, place.norm());
  const LocalVoxels voxels(corridor, line, depth_mm, 1.5 * line.radius_mm + 1.5 + voxel);
  std::array<TipFit, 3> fits;
  for (std::size_t n = 0; n < fits.size(); ++n) {
    VoidShape start;
    start.line = line;
    start.depth = depth_mm + kStartsApart_mm * (static_cast<double>(n) - 1.0);
    start.soft = std::max(0.35, 0.25 * line.radius_mm);
    fits[n] = fit_from(corridor, voxels, start, voxel, chance);
  }
  TipFit best = *std::min_element(fits.begin(), fits.end(),
                                  [](const TipFit& a, const TipFit& b) { return a.chi2 < b.chi2; });
  // A void that leaves its slice near the tip can be explained in several ways; where these fit nearly as
  // well, their distance is doubt.
  double doubt = 0.0;
  for (const TipFit& other : fits)
    if (other.chi2 - best.chi2 < kNearlyAsWell * std::max(best.misfit, 0.5))
      doubt = std::max(doubt, std::abs(other.depth_mm - best.depth_mm));
  best.sigma_mm = std::hypot(best.sigma_mm, doubt / 1.5);
  return best;
}

}  // namespace biopsy::imaging
