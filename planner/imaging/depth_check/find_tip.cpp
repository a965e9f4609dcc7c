#include "planner/imaging/depth_check/find_tip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/core/optim.hpp>

#include "planner/imaging/depth_check/tip_fit.hpp"
#include "planner/imaging/depth_check/void_line.hpp"
#include "robot/common/statistics.hpp"

namespace biopsy::imaging {
namespace {

// Radii tried first, mm: from the thinnest void seen in half-millimetre pixels to the widest of ten pixels
// of 1.2 mm.
constexpr std::array<double, 5> kRadii{0.7, 1.2, 2.0, 3.3, 5.5};
// Nearer tips are weighed by the fit of the tip itself, in its sigma.
constexpr double kRivalApart_mm = 6.0;
constexpr double kChance = 5.0;  // standard deviations: once in a few million
constexpr double kDegree = std::numbers::pi / 180.0;

struct Candidate {
  VoidLine line;
  LineFit fit;
};

// The best line for each radius on a lattice of deviations around a path `centre` beside the axis.
std::vector<Candidate> coarse(const LineSearch& search, const Eigen::Vector2d& centre, double reach_mm,
                              double tilt_rad) {
  std::vector<Candidate> best;
  for (double radius : kRadii) {
    Candidate top;
    const double step = std::max(0.8, 0.6 * radius);
    const int n = static_cast<int>(std::ceil(reach_mm / step));
    const int tilts = tilt_rad > 0.0 && radius < 3.0 ? 1 : 0;
    for (int a = -tilts; a <= tilts; ++a)
      for (int b = -tilts; b <= tilts; ++b)
        for (int i = -n; i <= n; ++i)
          for (int j = -n; j <= n; ++j) {
            const Eigen::Vector2d place = centre + reach_mm / n * Eigen::Vector2d(i, j);
            const VoidLine line{place.x(), place.y(), a * tilt_rad, b * tilt_rad, radius};
            const LineFit fit = search.best_tip(search.profile(line));
            if (fit.gain > top.fit.gain) top = {line, fit};
          }
    best.push_back(top);
  }
  std::stable_sort(best.begin(), best.end(),
                   [](const Candidate& a, const Candidate& b) { return a.fit.gain > b.fit.gain; });
  return best;
}

// Deviation at the entry and 20 mm further, and width.
class LineCost : public cv::MinProblemSolver::Function {
 public:
  LineCost(const LineSearch& search, const VoidLine& start, const TipSettings& settings)
      : search_(search), start_(start), settings_(settings) {}

  int getDims() const override { return 5; }
  double calc(const double* x) const override {
    const VoidLine l = line(x);
    const double far = std::max(std::hypot(l.u, l.v) - settings_.deviation_max_mm - 1.0, 0.0);
    const double tilted =
        std::max(std::hypot(l.u_slope, l.v_slope) - std::tan((settings_.tilt_max_deg + 1.0) * kDegree), 0.0);
    const double width = std::max(l.radius_mm - 7.0, 0.0) + std::max(0.4 - l.radius_mm, 0.0);
    return -search_.best_tip(search_.profile(l)).gain * (1.0 - std::min(far + 50.0 * tilted + width, 1.0));
  }
  VoidLine line(const double* x) const {
    VoidLine l = start_;
    l.u += x[0], l.v += x[1];
    l.u_slope += (x[2] - x[0]) / 20.0, l.v_slope += (x[3] - x[1]) / 20.0;
    l.radius_mm *= std::exp(std::clamp(x[4], -1.0, 1.0));
    return l;
  }

 private:
  const LineSearch& search_;
  VoidLine start_;
  TipSettings settings_;
};

Candidate refined(const LineSearch& search, const Candidate& start, const TipSettings& settings) {
  const auto cost = cv::makePtr<LineCost>(search, start.line, settings);
  cv::Mat x = cv::Mat::zeros(1, 5, CV_64F);
  const double step = 0.5 * start.line.radius_mm + 0.2;
  const cv::Mat steps = (cv::Mat_<double>(1, 5) << step, step, step, step, 0.25);
  cv::DownhillSolver::create(cost, steps,
                             cv::TermCriteria(cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, 200, 1e-2))
      ->minimize(x);
  Candidate result{cost->line(x.ptr<double>()), {}};
  result.fit = search.best_tip(search.profile(result.line));
  return result.fit.gain > start.fit.gain ? result : start;
}

// The same search where no needle can be: paths parallel to the axis, 13 to 15 mm beside it.
double control_gain(const LineSearch& search, const Corridor& corridor) {
  constexpr int kPaths = 8;
  double most = 0.0;
  for (int n = 0; n < kPaths; ++n) {
    const double angle = 2.0 * std::numbers::pi * n / kPaths;
    const double beside = std::min(14.0, corridor.radius_mm - 5.0);
    const Eigen::Vector2d centre = beside * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    most = std::max(most, coarse(search, centre, 1.6, 0.0).front().fit.gain);
  }
  return most;
}

// Longest stretch after the entry and before the tip where the void is clearly missing: its loss is below 0.4
// of the rest's and known well enough to say so.
double longest_gap(const LineProfile& profile, const LineFit& fit) {
  constexpr std::size_t kStretch = 6;  // 3 mm of half-millimetre bins
  double longest = 0.0, current = 0.0;
  for (std::size_t bin = 0; bin + kStretch <= profile.match.size(); ++bin) {
    if (profile.at(bin) < std::max(fit.start_mm, 0.0) || profile.at(bin + kStretch) > fit.tip_mm) continue;
    double match = 0.0, energy = 0.0;
    for (std::size_t n = bin; n < bin + kStretch; ++n) match += profile.match[n], energy += profile.energy[n];
    const double loss = energy > 0.0 ? match / energy : 0.0,
                 sigma = energy > 0.0 ? 1.0 / std::sqrt(energy) : 1.0;
    const bool missing = loss + 2.0 * sigma < 0.4 * fit.loss;
    current = missing ? (current > 0.0 ? current + profile.bin_mm : profile.bin_mm * kStretch) : 0.0;
    longest = std::max(longest, current);
  }
  return longest;
}

void find_rival(const LineSearch& search, const LineProfile& profile, TipFinding& found) {
  const std::vector<double> gains = search.gain_by_tip(profile);
  const double best = *std::max_element(gains.begin(), gains.end());
  for (std::size_t n = 1; n + 1 < gains.size(); ++n) {
    const bool peak = gains[n] >= gains[n - 1] && gains[n] > gains[n + 1];
    const double against = std::sqrt(best - gains[n]);
    if (!peak || std::abs(profile.at(n) - found.depth_mm) < kRivalApart_mm || against >= found.rival_against)
      continue;
    found.rival_against = against;
    found.rival_depth_mm = profile.at(n);
  }
}

// A bubble or an old track that touches the tip looks like more needle as soon as it is a little out of
// place.
double darkest_at_tip(const Corridor& corridor, const VoidLine& line, double depth) {
  constexpr double kAbout_mm = 10.0;
  const double near_mm = 1.0 + 0.5 * corridor.along_mm, beside = line.radius_mm + 0.5;
  double darkest = std::numeric_limits<double>::max();
  std::vector<double> along;
  for (const CorridorVoxel& voxel : corridor.voxels) {
    const double t = static_cast<double>(voxel.t), from_tip = std::abs(t - depth);
    const double u = static_cast<double>(voxel.u) - line.u - line.u_slope * t;
    const double v = static_cast<double>(voxel.v) - line.v - line.v_slope * t;
    if (from_tip > kAbout_mm || std::hypot(u, v) > beside) continue;
    along.push_back(static_cast<double>(voxel.predicted));
    if (from_tip <= near_mm) darkest = std::min(darkest, along.back());
  }
  if (along.empty()) return 0.0;
  const double usual = median(std::move(along));
  return usual > 0.0 ? std::min(darkest / usual, 1.0) : 0.0;
}

// Evidence that a 1 mm void losing half its signal would give over the first 10 mm of the path.
double visibility(const LineSearch& search, const Corridor& corridor) {
  const LineProfile profile = search.profile(VoidLine{});
  double energy = 0.0;
  for (std::size_t n = 0; n < profile.energy.size(); ++n)
    if (profile.at(n) >= std::max(corridor.t_min, 0.0) &&
        profile.at(n) < std::max(corridor.t_min, 0.0) + 10.0)
      energy += profile.energy[n];
  return 0.5 * std::sqrt(energy);
}

}  // namespace

TipFinding find_tip(const Corridor& corridor, const TipSettings& settings) {
  const LineSearch search(corridor, settings.depth_min_mm, settings.depth_max_mm);
  const double tilt = 0.75 * settings.tilt_max_deg * kDegree;
  const std::vector<Candidate> tops =
      coarse(search, Eigen::Vector2d::Zero(), settings.deviation_max_mm, tilt);
  Candidate best = refined(search, tops[0], settings);
  const Candidate other = refined(search, tops[1], settings);
  if (other.fit.gain > best.fit.gain) best = other;

  TipFinding found;
  found.evidence = std::sqrt(std::max(best.fit.gain, 0.0));
  found.control_evidence = std::sqrt(control_gain(search, corridor));
  found.visible = visibility(search, corridor);
  if (best.fit.gain <= 0.0) return found;
  const TipFit fit = fit_tip(corridor, best.line, best.fit.tip_mm, std::max(found.control_evidence, kChance));
  const LineProfile profile = search.profile(best.line);
  found.loss = fit.loss;
  found.radius_mm = fit.line.radius_mm;
  found.depth_mm = fit.depth_mm;
  found.sigma_mm = fit.sigma_mm;
  found.low_mm = fit.low_mm;
  found.high_mm = fit.high_mm;
  found.across_mm = fit.line.u + fit.line.u_slope * fit.depth_mm;
  found.up_mm = fit.line.v + fit.line.v_slope * fit.depth_mm;
  found.tilt_deg = std::atan(std::hypot(fit.line.u_slope, fit.line.v_slope)) / kDegree;
  found.gap_mm = longest_gap(profile, best.fit);
  found.darkest = darkest_at_tip(corridor, fit.line, fit.depth_mm);
  found.at_end = fit.depth_mm > corridor.t_max - std::max(1.0, 0.5 * corridor.along_mm);
  find_rival(search, profile, found);
  return found;
}

}  // namespace biopsy::imaging
