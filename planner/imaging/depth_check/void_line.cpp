#include "planner/imaging/depth_check/void_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace biopsy::imaging {
namespace {

constexpr double kColumn_mm = 2.0;
constexpr double kBin_mm = 0.5;

double gain_of(double match, double energy, double& loss) {
  loss = energy > 0.0 ? std::clamp(match / energy, 0.0, kLossMost) : 0.0;
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

// The share of a voxel's cross-section that a soft disc covers.
struct DiscCoverage {
  const std::vector<Eigen::Vector2d>& places;
  double soft, outer, reach_mm = 0.0;

  DiscCoverage(double radius_mm, const std::vector<Eigen::Vector2d>& places_in_voxel)
      : places(places_in_voxel), soft(std::max(0.35, 0.25 * radius_mm)), outer(radius_mm + soft) {
    for (const Eigen::Vector2d& place : places) reach_mm = std::max(reach_mm, outer + place.norm());
  }
  double of_voxel(double du, double dv) const {
    if (du * du + dv * dv > reach_mm * reach_mm) return 0.0;
    double covered = 0.0;
    for (const Eigen::Vector2d& place : places) {
      const double x = du + place.x(), y = dv + place.y();
      covered += std::clamp((outer - std::sqrt(x * x + y * y)) / (2.0 * soft), 0.0, 1.0);
    }
    return covered / static_cast<double>(places.size());
  }
};

}  // namespace

LineSearch::LineSearch(const Corridor& corridor, double depth_min_mm, double depth_max_mm)
    : corridor_(corridor), depth_min_mm_(depth_min_mm), depth_max_mm_(depth_max_mm) {
  cells_ = 2 * static_cast<int>(std::ceil(corridor.radius_mm / kColumn_mm));
  grid_.resize(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_));
  for (std::uint32_t n : corridor.thinned) {
    const CorridorVoxel& voxel = corridor.voxels[n];
    const int row = cell_of(static_cast<double>(voxel.v)), column = cell_of(static_cast<double>(voxel.u));
    grid_[cell(row, column)].push_back(n);
  }
}

int LineSearch::cell_of(double beside_mm) const {
  return std::clamp(static_cast<int>(std::floor(beside_mm / kColumn_mm)) + cells_ / 2, 0, cells_ - 1);
}

LineSearch::CellRange LineSearch::cells_near(double at_entry, double slope, double reach_mm) const {
  const double a = at_entry + slope * corridor_.t_min, b = at_entry + slope * corridor_.t_max;
  return {cell_of(std::min(a, b) - reach_mm), cell_of(std::max(a, b) + reach_mm)};
}

LineProfile LineSearch::profile(const VoidLine& line) const {
  const auto bins =
      static_cast<std::size_t>(std::max((corridor_.t_max - corridor_.t_min) / kBin_mm, 0.0)) + 1;
  LineProfile result{corridor_.t_min, kBin_mm, std::vector<double>(bins, 0.0),
                     std::vector<double>(bins, 0.0)};
  std::vector<DiscCoverage> discs;
  double reach_mm = 0.0;
  for (const Stack& stack : corridor_.stacks) {
    discs.emplace_back(line.radius_mm, stack.lateral);
    reach_mm = std::max(reach_mm, discs.back().reach_mm);
  }
  const CellRange columns = cells_near(line.u, line.u_slope, reach_mm);
  const CellRange rows = cells_near(line.v, line.v_slope, reach_mm);
  for (int row = rows.first; row <= rows.last; ++row)
    for (int column = columns.first; column <= columns.last; ++column)
      for (std::uint32_t n : grid_[cell(row, column)]) {
        const CorridorVoxel& voxel = corridor_.voxels[n];
        const double t = static_cast<double>(voxel.t);
        const double covered =
            discs[voxel.stack].of_voxel(static_cast<double>(voxel.u) - line.u - line.u_slope * t,
                                        static_cast<double>(voxel.v) - line.v - line.v_slope * t);
        if (covered <= 0.0) continue;
        const double predicted = static_cast<double>(voxel.predicted);
        const double shape = predicted * covered, weight = shape / static_cast<double>(voxel.variance);
        const auto bin = std::min(static_cast<std::size_t>((t - corridor_.t_min) / kBin_mm), bins - 1);
        result.match[bin] += weight * (predicted - static_cast<double>(voxel.measured));
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
      gains[tip] =
          std::max(gains[tip], gain_of(match[tip] - match[start], energy[tip] - energy[start], loss));
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
