#include "planner/imaging/void_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace biopsy::imaging {
namespace {

constexpr double kCell_mm = 2.0;
constexpr double kBin_mm = 0.5;
constexpr double kLossMax = 1.1;  // a void cannot lose more than everything; a little for brightness errors

double gain_of(double match, double energy, double& loss) {
  loss = energy > 0.0 ? std::clamp(match / energy, 0.0, kLossMax) : 0.0;
  return loss * (2.0 * match - loss * energy);
}

// Running sums, so that any stretch costs two look-ups.
std::vector<double> sums_to(const std::vector<double>& bins) {
  std::vector<double> sums{0.0};
  for (double bin : bins) sums.push_back(sums.back() + bin);
  return sums;
}

// A shaft may come into view behind the entry at one of these: further back nothing is known about it.
std::array<std::size_t, 4> starts(const LineProfile& profile) {
  std::array<std::size_t, 4> bins{};
  const double length = std::max(-profile.t_min, 0.0);
  for (std::size_t n = 0; n < bins.size(); ++n)
    bins[n] = std::min(static_cast<std::size_t>(length * static_cast<double>(n) / 3.0 / profile.bin_mm),
                       profile.match.size());
  return bins;
}

}  // namespace

LineSearch::LineSearch(const Corridor& corridor, double depth_min_mm, double depth_max_mm)
    : corridor_(corridor), depth_min_mm_(depth_min_mm), depth_max_mm_(depth_max_mm) {
  cells_ = 2 * static_cast<int>(std::ceil(corridor.radius_mm / kCell_mm));
  grid_.resize(static_cast<std::size_t>(cells_ * cells_));
  const auto cell = [&](float x) {
    return std::clamp(static_cast<int>(std::floor(static_cast<double>(x) / kCell_mm)) + cells_ / 2, 0, cells_ - 1);
  };
  for (std::uint32_t n : corridor.thinned)
    grid_[static_cast<std::size_t>(cell(corridor.voxels[n].v) * cells_ + cell(corridor.voxels[n].u))]
        .voxels.push_back(n);
}

LineProfile LineSearch::profile(const VoidLine& line) const {
  LineProfile result{corridor_.t_min, kBin_mm, {}, {}};
  const auto bins = static_cast<std::size_t>(std::max((corridor_.t_max - corridor_.t_min) / kBin_mm, 0.0)) + 1;
  result.match.assign(bins, 0.0);
  result.energy.assign(bins, 0.0);
  const double soft = std::max(0.35, 0.25 * line.radius_mm), outer = line.radius_mm + soft;
  double voxel = 0.0;
  for (const Eigen::Vector2d& place : corridor_.lateral) voxel = std::max(voxel, place.norm());
  const double reach = outer + voxel;
  const auto range = [&](double at_entry, double slope) {
    const double a = at_entry + slope * corridor_.t_min, b = at_entry + slope * corridor_.t_max;
    const auto cell = [&](double x) {
      return std::clamp(static_cast<int>(std::floor(x / kCell_mm)) + cells_ / 2, 0, cells_ - 1);
    };
    return std::pair(cell(std::min(a, b) - reach), cell(std::max(a, b) + reach));
  };
  const auto [u_low, u_high] = range(line.u, line.u_slope);
  const auto [v_low, v_high] = range(line.v, line.v_slope);
  const double per_place = 1.0 / static_cast<double>(corridor_.lateral.size());
  for (int row = v_low; row <= v_high; ++row)
    for (int column = u_low; column <= u_high; ++column)
      for (std::uint32_t n : grid_[static_cast<std::size_t>(row * cells_ + column)].voxels) {
        const CorridorVoxel& voxel_n = corridor_.voxels[n];
        const double t = static_cast<double>(voxel_n.t);
        const double du = static_cast<double>(voxel_n.u) - line.u - line.u_slope * t;
        const double dv = static_cast<double>(voxel_n.v) - line.v - line.v_slope * t;
        if (du * du + dv * dv > reach * reach) continue;
        double covered = 0.0;
        for (const Eigen::Vector2d& place : corridor_.lateral) {
          const double x = du + place.x(), y = dv + place.y();
          covered += std::clamp((outer - std::sqrt(x * x + y * y)) / (2.0 * soft), 0.0, 1.0);
        }
        if (covered <= 0.0) continue;
        const double predicted = static_cast<double>(voxel_n.predicted);
        const double shape = predicted * covered * per_place;
        const double weight = shape / static_cast<double>(voxel_n.variance);
        const auto bin = std::min(static_cast<std::size_t>((t - corridor_.t_min) / kBin_mm), bins - 1);
        result.match[bin] += weight * (predicted - static_cast<double>(voxel_n.measured));
        result.energy[bin] += weight * shape;
      }
  return result;
}

std::vector<double> LineSearch::gain_by_tip(const LineProfile& profile) const {
  const std::vector<double> match = sums_to(profile.match), energy = sums_to(profile.energy);
  std::vector<double> gains(match.size(), 0.0);
  for (std::size_t start : starts(profile))
    for (std::size_t tip = start + 1; tip < match.size(); ++tip) {
      double loss;
      gains[tip] = std::max(gains[tip], gain_of(match[tip] - match[start], energy[tip] - energy[start], loss));
    }
  return gains;
}

LineFit LineSearch::best_tip(const LineProfile& profile) const {
  const std::vector<double> match = sums_to(profile.match), energy = sums_to(profile.energy);
  LineFit best;
  for (std::size_t start : starts(profile))
    for (std::size_t tip = start + 1; tip < match.size(); ++tip) {
      if (profile.at(tip) < depth_min_mm_ || profile.at(tip) > depth_max_mm_) continue;
      double loss;
      const double gain = gain_of(match[tip] - match[start], energy[tip] - energy[start], loss);
      if (gain > best.gain) best = {gain, loss, profile.at(start), profile.at(tip)};
    }
  return best;
}

}  // namespace biopsy::imaging
