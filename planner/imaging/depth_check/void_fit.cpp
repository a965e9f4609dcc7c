#include "planner/imaging/depth_check/void_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "planner/imaging/depth_check/control_places.hpp"
#include "planner/imaging/depth_check/reflected_lines.hpp"
#include "planner/imaging/depth_check/void_shape.hpp"

namespace biopsy::imaging {
namespace {

constexpr double kBeyond_mm = 8.0;  // of the tissue ahead of the tip that is fitted with it
constexpr double kNear_mm = 10.0;   // about the tip; what lies further up the shaft is thinned more
constexpr std::size_t kVoxelsMax = 3000, kVoxelsFirst = 800;  // about the tip; half of that along the shaft
constexpr double kClip = 4.0;  // standard deviations; larger residuals pull no harder (Huber)

// What is known of a needle's void before any image. Wide: they only keep what an image does not tell in
// bounds. Zero: nothing is known.
VoidVector prior_sigma() {
  VoidVector sigma = VoidVector::Zero();
  sigma[kLogRadius] = 0.8, sigma[kLogSoft] = 0.5, sigma[kRounding] = 0.35, sigma[kLoss] = 0.5;
  return sigma;
}

VoidVector prior_mean(double radius_mm) {
  VoidVector mean = VoidVector::Zero();
  mean[kLogRadius] = std::log(radius_mm);
  mean[kLogSoft] = std::log(std::max(0.35, 0.3 * radius_mm));
  mean[kRounding] = 0.5, mean[kLoss] = 0.9;
  return mean;
}

double huber(double z) {
  const double size = std::abs(z);
  return size <= kClip ? size * size : kClip * (2.0 * size - kClip);
}

bool is_near(const CorridorVoxel& voxel, const VoidLine& line, double reach_mm) {
  const double t = static_cast<double>(voxel.t),
               du = static_cast<double>(voxel.u) - line.u - line.u_slope * t,
               dv = static_cast<double>(voxel.v) - line.v - line.v_slope * t;
  return du * du + dv * dv <= reach_mm * reach_mm;
}

class Fitting {
 public:
  Fitting(const Corridor& corridor, const VoidLine& line, double depth_mm, std::size_t voxels_max)
      : corridor_(corridor), tip_mm_(depth_mm), mean_(prior_mean(line.radius_mm)), sigma_(prior_sigma()) {
    double voxel = 0.0;
    for (const Stack& stack : corridor.stacks)
      for (const Eigen::Vector2d& place : stack.lateral) voxel = std::max(voxel, place.norm());
    const double reach = 1.5 * line.radius_mm + 1.5 + voxel;
    std::vector<std::uint32_t> shaft, tip;
    for (std::size_t n = 0; n < corridor.voxels.size(); ++n) {
      const CorridorVoxel& one = corridor.voxels[n];
      const double t = static_cast<double>(one.t);
      if (!is_near(one, line, reach) || t > depth_mm + kBeyond_mm + corridor.along_mm) continue;
      (t > depth_mm - kNear_mm ? tip : shaft).push_back(static_cast<std::uint32_t>(n));
    }
    keep(tip, voxels_max), keep(shaft, voxels_max / 2);
  }

  VoidVector start(const VoidLine& line, double depth_mm) const {
    VoidVector x = mean_;
    x[kDepth] = depth_mm;
    x[kU] = line.u + line.u_slope * tip_mm_, x[kV] = line.v + line.v_slope * tip_mm_;
    x[kUSlope] = line.u_slope, x[kVSlope] = line.v_slope;
    return x;
  }
  VoidShape shape(const VoidVector& x) const {
    VoidShape shape;
    shape.depth = x[kDepth];
    shape.line = {x[kU] - x[kUSlope] * tip_mm_, x[kV] - x[kVSlope] * tip_mm_, x[kUSlope], x[kVSlope],
                  std::exp(std::clamp(x[kLogRadius], -1.2, 2.1))};
    shape.soft = std::exp(std::clamp(x[kLogSoft], -1.6, 1.6));
    shape.rounding = std::clamp(x[kRounding], 0.0, 1.0);
    return shape;
  }
  std::size_t size() const { return used_.size(); }
  const std::vector<std::uint32_t>& used() const { return used_; }

  // Huber's cost of all voxels and the prior's.
  double cost(const VoidVector& x) const {
    const std::vector<double> z = residuals(x);
    double sum = prior_cost(x);
    for (double one : z) sum += huber(one);
    return sum;
  }
  double prior_cost(const VoidVector& x) const {
    double sum = 0.0;
    for (int p = 0; p < kVoidParameters; ++p)
      if (sigma_[p] > 0.0) sum += std::pow((x[p] - mean_[p]) / sigma_[p], 2);
    return sum;
  }
  // (measured - model) / standard deviation
  std::vector<double> residuals(const VoidVector& x) const { return residuals(coverages(x), x[kLoss]); }
  // Levenberg and Marquardt's least squares with numeric slopes.
  VoidVector minimised(VoidVector x) const {
    double best = cost(x), damping = 1e-2;
    for (int iteration = 0; iteration < 25 && damping < 1e6; ++iteration) {
      VoidMatrix normal;
      VoidVector right;
      normal_equations(x, normal, right, nullptr);
      bool better = false;
      for (; !better && damping < 1e6; damping *= better ? 0.2 : 5.0) {
        VoidMatrix damped = normal;
        damped.diagonal() *= 1.0 + damping;
        damped.diagonal().array() += 1e-9;
        const VoidVector step = damped.ldlt().solve(right);
        if (!step.allFinite()) return x;
        VoidVector there = x + step;  // a loss beyond its bounds would say that nothing depends on it
        there[kLoss] = std::clamp(there[kLoss], 0.0, kLossMost);
        const double value = cost(there);
        better = value < best;
        if (!better) continue;
        const bool done = best - value < 1e-3 * (1.0 + 1e-3 * best);
        x = there, best = value;
        if (done) return x;
      }
    }
    return x;
  }
  void normal_equations(const VoidVector& x, VoidMatrix& normal, VoidVector& right,
                        std::vector<TemplateVoxel>* slopes) const {
    const std::vector<double> covered = coverages(x), z = residuals(covered, x[kLoss]);
    std::array<std::vector<double>, kVoidParameters> moved;
    VoidVector by;
    by << 0.05, 0.05, 0.05, 0.002, 0.002, 0.03, 0.05, 0.1, 0.02;
    if (x[kRounding] > 0.5) by[kRounding] = -by[kRounding];
    if (x[kLoss] > 1.0) by[kLoss] = -by[kLoss];
    // A step needs no better slopes than these: a tilt moves a voxel's middle beside the tip's line.
    const auto tilts = [&](int p) { return !slopes && (p == kUSlope || p == kVSlope); };
    for (int p = 0; p < kVoidParameters; ++p) {
      if (tilts(p)) continue;
      VoidVector there = x;
      there[p] += by[p];
      moved[static_cast<std::size_t>(p)] = p == kLoss ? residuals(covered, there[p]) : residuals(there);
    }
    normal.setZero(), right.setZero();
    for (std::size_t n = 0; n < z.size(); ++n) {
      VoidVector slope;
      for (int p = 0; p < kVoidParameters; ++p)
        if (!tilts(p)) slope[p] = (z[n] - moved[static_cast<std::size_t>(p)][n]) / by[p];
      if (!slopes) {
        const double from_tip = static_cast<double>(corridor_.voxels[used_[n]].t) - tip_mm_;
        slope[kUSlope] = from_tip * slope[kU], slope[kVSlope] = from_tip * slope[kV];
      }
      const double weight = std::abs(z[n]) <= kClip ? 1.0 : kClip / std::abs(z[n]);
      normal += weight * slope * slope.transpose();
      right += weight * z[n] * slope;
      if (slopes) slopes->push_back({used_[n], std::sqrt(weight) * slope});
    }
    for (int p = 0; p < kVoidParameters; ++p)
      if (sigma_[p] > 0.0) {
        normal(p, p) += 1.0 / (sigma_[p] * sigma_[p]);
        right[p] -= (x[p] - mean_[p]) / (sigma_[p] * sigma_[p]);
      }
  }

 private:
  std::vector<double> coverages(const VoidVector& x) const {
    const VoidShape s = shape(x);
    std::vector<double> covered;
    covered.reserve(used_.size());
    for (std::uint32_t n : used_) covered.push_back(coverage(corridor_, corridor_.voxels[n], s));
    return covered;
  }
  std::vector<double> residuals(const std::vector<double>& covered, double loss) const {
    loss = std::clamp(loss, 0.0, kLossMost);
    std::vector<double> z;
    z.reserve(used_.size());
    for (std::size_t n = 0; n < used_.size(); ++n) {
      const CorridorVoxel& voxel = corridor_.voxels[used_[n]];
      const double model = static_cast<double>(voxel.predicted) * (1.0 - loss * covered[n]);
      z.push_back((static_cast<double>(voxel.measured) - model) /
                  std::sqrt(static_cast<double>(voxel.variance)));
    }
    return z;
  }
  void keep(const std::vector<std::uint32_t>& some, std::size_t most) {
    const std::size_t every = some.size() / most + 1;
    for (std::size_t n = 0; n < some.size(); n += every) used_.push_back(some[n]);
  }

  const Corridor& corridor_;
  double tip_mm_;
  VoidVector mean_, sigma_;
  std::vector<std::uint32_t> used_;
};

// The errors of a fit, as measured beside it.
void measure_errors(const Corridor& corridor, const Fitting& fitting, const VoidVector& x, VoidFit& fit) {
  VoidMatrix normal;
  VoidVector right;
  std::vector<TemplateVoxel> slopes;
  fitting.normal_equations(x, normal, right, &slopes);
  normal.diagonal().array() += 1e-9;
  const VoidMatrix alone = normal.inverse();  // covariance if voxels erred alone
  const double clear_mm = fit.line.radius_mm + fit.soft_mm + 1.0;
  const ControlPlaces control = at_control_places(corridor, slopes, alone, fit, kClip, clear_mm);
  fit.control_places = control.count;
  // A void that the model explains worse than the rest of the images is explained is read worse as well.
  const double worse = std::max(fit.misfit / std::max(control.mean_square, 0.1), 1.0);
  fit.covariance = worse * (control.covariance + alone);
  // The loss with all else held: a thin void can be narrow and dark or wide and grey, but it is there.
  double information = 0.0;
  for (const TemplateVoxel& one : slopes) information += one.slope[kLoss] * one.slope[kLoss];
  information = std::max(information, 1e-9);
  fit.inflation = std::max(worse * (control.loss_alone / information + 1.0), 1.0);
  fit.loss_sigma = std::sqrt(fit.inflation / information);
}

VoidFit fitted(const Corridor& corridor, const VoidLine& line, double depth_mm,
               const std::vector<double>& starts_mm, std::size_t voxels_max) {
  const Fitting rough(corridor, line, depth_mm, kVoxelsFirst), fitting(corridor, line, depth_mm, voxels_max);
  VoidVector start = rough.start(line, depth_mm);
  double least = 1e300;
  for (double apart : starts_mm) {
    const VoidVector x = rough.minimised(rough.start(line, depth_mm + apart));
    const double cost = rough.cost(x);
    if (cost < least) least = cost, start = x;
  }
  const VoidVector best = voxels_max > kVoxelsFirst ? fitting.minimised(start) : start;
  least = fitting.cost(best);
  VoidFit fit;
  const VoidShape shape = fitting.shape(best);
  fit.line = shape.line;
  fit.depth_mm = shape.depth;
  // Of a void that goes on to where the images end, where it leaves them.
  const double seen_mm = std::min(fit.depth_mm, corridor.t_max);
  fit.u_mm = fit.line.u + fit.line.u_slope * seen_mm;
  fit.v_mm = fit.line.v + fit.line.v_slope * seen_mm;
  fit.soft_mm = shape.soft, fit.rounding = shape.rounding;
  fit.loss = std::clamp(best[kLoss], 0.0, kLossMost);
  fit.chi2 = least - fitting.prior_cost(best);
  VoidVector nothing = best;
  nothing[kLoss] = 0.0;
  fit.gain = fitting.cost(nothing) - fitting.prior_cost(nothing) - fit.chi2;
  fit.misfit = fit.chi2 / std::max(static_cast<double>(fitting.size()) - kVoidParameters, 1.0);
  if (fit.gain > 0.0) measure_errors(corridor, fitting, best, fit);
  return fit;
}

// Beyond all that was searched: such a fit was led away by what is no needle, another dark place or an edge.
bool strayed(const VoidFit& fit, const SearchReach& reach) {
  constexpr double kMargin_mm = 3.0, kMargin_deg = 4.0;  // a candidate is known to about 2 mm and 2 degrees
  const double steepest = std::tan((reach.tilt_deg + kMargin_deg) * std::numbers::pi / 180.0);
  const double farthest_mm = reach.beside_mm + kMargin_mm;
  return !(std::hypot(fit.line.u_slope, fit.line.v_slope) <= steepest &&
           std::hypot(fit.line.u, fit.line.v) <= farthest_mm &&
           std::hypot(fit.u_mm, fit.v_mm) <= farthest_mm + steepest * std::max(fit.depth_mm, 0.0));
}

// Whether the images say where the void ends, to within what was searched.
bool is_told(const VoidFit& fit, const SearchReach& reach) {
  const double searched_mm = reach.depth_max_mm - reach.depth_min_mm;
  return fit.gain > 0.0 && fit.covariance(kDepth, kDepth) < searched_mm * searched_mm;
}

// What the centreline loses. A wide void fades towards its rim in more ways than one edge has: all of it
// loses less than its core, and where the core has lost half of that lies beyond the end.
double loss_of_core(const Corridor& corridor, const VoidFit& fit,
                    const std::vector<const CorridorVoxel*>& core) {
  constexpr double kApart = 0.1;    // of the two losses, one standard deviation
  constexpr double kWithin = 0.95;  // of a voxel lies in the void
  const VoidShape shape{fit.line, fit.depth_mm, fit.soft_mm, fit.rounding};
  double energy = 1.0 / (kApart * kApart), match = fit.loss * energy;
  for (const CorridorVoxel* one : core) {
    const double covered = coverage(corridor, *one, shape);
    if (covered < kWithin) continue;
    const double full = covered * static_cast<double>(one->predicted);
    const double weight = 1.0 / (fit.inflation * static_cast<double>(one->variance));
    match += weight * full * static_cast<double>(one->predicted - one->measured);
    energy += weight * full * full;
  }
  return std::clamp(match / energy, 0.0, kLossMost);
}

// What a void in the reflected place explains as well as the fit, by three standard deviations.
void look_elsewhere(const Corridor& corridor, VoidFit& fit) {
  constexpr double kAlike = 9.0;
  const std::vector<PlacedLine> others = reflected_lines(corridor, {fit.line, fit.depth_mm});
  if (others.empty()) return;
  const VoidFit here = fitted(corridor, fit.line, fit.depth_mm, {0.0}, kVoxelsFirst);
  for (const PlacedLine& other : others) {
    const VoidFit there = fitted(corridor, other.line, other.depth_mm, {0.0}, kVoxelsFirst);
    if (there.gain < here.gain - kAlike * fit.inflation) continue;
    const Eigen::Vector2d place(there.u_mm - fit.u_mm, there.v_mm - fit.v_mm),
        slope(there.line.u_slope - fit.line.u_slope, there.line.v_slope - fit.line.v_slope);
    if (place.norm() > fit.other_place.norm()) fit.other_place = place;
    if (slope.norm() > fit.other_slope.norm()) fit.other_slope = slope;
  }
}

}  // namespace

VoidFit fit_void(const Corridor& corridor, const std::vector<LineCandidate>& candidates,
                 const SearchReach& reach) {
  std::vector<VoidFit> fits;
  bool led_away = false;
  for (const LineCandidate& candidate : candidates) {
    const VoidFit one = fitted(corridor, candidate.line, candidate.fit.tip_mm, {0.0}, kVoxelsFirst);
    if (one.gain <= 0.0) continue;
    if (strayed(one, reach))
      led_away = true;
    else
      fits.push_back(one);
  }
  if (fits.empty()) {
    VoidFit nothing;
    nothing.led_away = led_away;
    return nothing;
  }
  // What is certainly dark first, not what explains most: a wide place that is a little darker explains much.
  std::ranges::stable_sort(fits, std::ranges::greater{},
                           [](const VoidFit& fit) { return std::pair(fit.evidence(), fit.gain); });
  // Again with the voxels about the line that was found, from ends ahead of it and behind as well: which of
  // the minima is the lowest a part of the voxels tells. Where the end of that void is not told at all, it is
  // the next place's turn.
  const auto refitted = [&](const VoidFit& fit) {
    const VoidFit again = fitted(corridor, fit.line, fit.depth_mm, {0.0, -2.0, 2.0}, kVoxelsMax);
    return strayed(again, reach) ? fit : again;
  };
  VoidFit found = refitted(fits.front());
  for (std::size_t n = 1; n < fits.size() && !is_told(found, reach); ++n)
    if (const VoidFit next = refitted(fits[n]); is_told(next, reach)) found = next;
  if (found.gain > 0.0) look_elsewhere(corridor, found);
  return found;
}

std::vector<double> chi2_by_depth(const Corridor& corridor, const VoidFit& fit,
                                  const std::vector<double>& depths) {
  double voxel_mm = 0.0;
  for (const Stack& stack : corridor.stacks)
    for (const Eigen::Vector2d& place : stack.lateral) voxel_mm = std::max(voxel_mm, place.norm());
  const double reach = 0.5 * fit.line.radius_mm + 0.35 + voxel_mm;
  std::vector<const CorridorVoxel*> core;
  for (const CorridorVoxel& one : corridor.voxels)
    if (is_near(one, fit.line, reach)) core.push_back(&one);
  const double loss = loss_of_core(corridor, fit, core);
  std::vector<double> chi2(depths.size(), 0.0);
  for (const CorridorVoxel* one : core) {
    const auto of_depth = [&](double depth) {
      const VoidShape shape{fit.line, depth, fit.soft_mm, fit.rounding};
      const double model =
          static_cast<double>(one->predicted) * (1.0 - loss * coverage(corridor, *one, shape));
      return huber((static_cast<double>(one->measured) - model) /
                   std::sqrt(static_cast<double>(one->variance)));
    };
    // Away from its end the void is the same wherever that is.
    const double half_mm = static_cast<double>(corridor.stacks[one->stack].places.col(0).abs().maxCoeff());
    const double t = static_cast<double>(one->t), ahead = t - half_mm - fit.soft_mm,
                 behind = t + half_mm + fit.soft_mm + fit.rounding * fit.line.radius_mm;
    const double outside = of_depth(ahead - 1.0), inside = of_depth(behind + 1.0);
    for (std::size_t n = 0; n < depths.size(); ++n)
      chi2[n] += depths[n] < ahead ? outside : depths[n] > behind ? inside : of_depth(depths[n]);
  }
  return chi2;
}

}  // namespace biopsy::imaging
