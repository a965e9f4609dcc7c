#include "planner/imaging/depth_check/line_candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "robot/common/statistics.hpp"

namespace biopsy::imaging {
namespace {

// From the thinnest void seen in half-millimetre pixels to the widest of ten pixels of 1.2 mm.
constexpr std::array<double, 5> kRadii{0.7, 1.2, 2.0, 3.3, 5.5};
constexpr double kSlab_mm = 2.0;
constexpr double kTiltStep_deg = 1.5;
constexpr std::size_t kStarts = 4;  // a shaft may come into view behind the entry at one of these

// As fine as the disc about it asks for.
double cell_mm(double radius_mm) {
  constexpr double kCellLeast_mm = 0.75;
  return std::max(kCellLeast_mm, radius_mm / 3.0);
}

// Per slab: sums of template * change / variance and template^2 / variance, for a disc about each cell.
struct SlabMaps {
  double cell_mm = 0.0;
  int cells = 0;  // per side of a square about the axis
  double t_min = 0.0;
  std::vector<cv::Mat> match, energy;

  double t(std::size_t slab) const { return t_min + (static_cast<double>(slab) + 0.5) * kSlab_mm; }
  int cell_of(double beside_mm) const {
    return static_cast<int>(std::floor(beside_mm / cell_mm + 0.5)) + cells / 2;
  }
};

// The voxels' own sums by cell, before any disc.
SlabMaps point_maps(const Corridor& corridor, double cell_mm) {
  SlabMaps maps;
  maps.cell_mm = cell_mm;
  maps.cells = 2 * static_cast<int>(std::ceil(corridor.radius_mm / cell_mm)) + 1;
  maps.t_min = corridor.t_min;
  const auto slabs =
      static_cast<std::size_t>(std::max((corridor.t_max - corridor.t_min) / kSlab_mm, 0.0)) + 1;
  for (std::size_t n = 0; n < slabs; ++n) {
    maps.match.push_back(cv::Mat::zeros(maps.cells, maps.cells, CV_32F));
    maps.energy.push_back(cv::Mat::zeros(maps.cells, maps.cells, CV_32F));
  }
  for (const CorridorVoxel& voxel : corridor.voxels) {
    const auto slab = std::min(
        static_cast<std::size_t>(std::max((static_cast<double>(voxel.t) - maps.t_min) / kSlab_mm, 0.0)),
        slabs - 1);
    const int row = maps.cell_of(static_cast<double>(voxel.v)),
              column = maps.cell_of(static_cast<double>(voxel.u));
    if (row < 0 || column < 0 || row >= maps.cells || column >= maps.cells) continue;
    const float per_variance = voxel.predicted / voxel.variance;
    maps.match[slab].at<float>(row, column) += per_variance * (voxel.predicted - voxel.measured);
    maps.energy[slab].at<float>(row, column) += per_variance * voxel.predicted;
  }
  return maps;
}

// Share of a voxel's cross-section that a disc covers, by the distance of their centres in cells.
cv::Mat disc_kernel(const Corridor& corridor, double radius_mm, double cell_mm) {
  std::vector<Eigen::Vector2d> places;
  double wide = 0.0;
  for (const Stack& stack : corridor.stacks)
    for (const Eigen::Vector2d& place : stack.lateral) {
      places.push_back(place);
      wide = std::max(wide, place.norm());
    }
  const double soft = std::max(0.35, 0.25 * radius_mm);
  const int half = static_cast<int>(std::ceil((radius_mm + soft + wide) / cell_mm));
  cv::Mat kernel(2 * half + 1, 2 * half + 1, CV_32F);
  for (int row = -half; row <= half; ++row)
    for (int column = -half; column <= half; ++column) {
      double covered = 0.0;
      for (const Eigen::Vector2d& place : places) {
        const double from_axis = (place + cell_mm * Eigen::Vector2d(column, row)).norm();
        covered += std::clamp((radius_mm + soft - from_axis) / (2.0 * soft), 0.0, 1.0);
      }
      kernel.at<float>(row + half, column + half) =
          static_cast<float>(covered / static_cast<double>(places.size()));
    }
  return kernel;
}

SlabMaps disc_maps(const SlabMaps& points, const cv::Mat& kernel) {
  SlabMaps maps = points;
  const cv::Mat squared = kernel.mul(kernel);
  for (std::size_t n = 0; n < points.match.size(); ++n) {
    cv::Mat match, energy;
    cv::filter2D(points.match[n], match, CV_32F, kernel, cv::Point(-1, -1), 0.0, cv::BORDER_CONSTANT);
    cv::filter2D(points.energy[n], energy, CV_32F, squared, cv::Point(-1, -1), 0.0, cv::BORDER_CONSTANT);
    maps.match[n] = match, maps.energy[n] = energy;
  }
  return maps;
}

// As measured beside the needle's reach, on stretches of 10 mm.
double inflation_of(const SlabMaps& maps, double from_mm, double to_mm) {
  constexpr std::size_t kStretch = 5;
  constexpr double kMedianOfSquare = 0.455;  // of a normal variable
  std::vector<double> squares;
  for (std::size_t slab = 0; slab + kStretch <= maps.match.size(); slab += kStretch) {
    cv::Mat match = maps.match[slab].clone(), energy = maps.energy[slab].clone();
    for (std::size_t n = slab + 1; n < slab + kStretch; ++n) match += maps.match[n], energy += maps.energy[n];
    for (int row = 0; row < maps.cells; ++row)
      for (int column = 0; column < maps.cells; ++column) {
        const double beside = maps.cell_mm * std::hypot(row - maps.cells / 2, column - maps.cells / 2);
        const auto m = static_cast<double>(match.at<float>(row, column)),
                   e = static_cast<double>(energy.at<float>(row, column));
        if (beside >= from_mm && beside <= to_mm && e > 0.0) squares.push_back(m * m / e);
      }
  }
  return squares.size() < 20 ? 1.0 : std::max(median(std::move(squares)) / kMedianOfSquare, 1.0);
}

// The cells that a line passes, slab by slab, in one direction beside the axis; -1 outside.
std::vector<int> cells_along(const SlabMaps& maps, double at_entry, double slope) {
  std::vector<int> cells;
  for (std::size_t slab = 0; slab < maps.match.size(); ++slab) {
    const int cell = maps.cell_of(at_entry + slope * maps.t(slab));
    cells.push_back(cell < maps.cells ? std::max(cell, -1) : -1);
  }
  return cells;
}

// Match and energy in the rows that a line passes; nullptr outside.
using Rows = std::vector<const cv::Vec2f*>;

// Where a shaft may come into view and where it may end, in slabs.
struct Ends {
  std::array<std::size_t, kStarts> starts{};
  std::array<double, kStarts> starts_mm{};
  std::size_t first = 0, last = 0;  // of the ends; `last` is one too far
};

Ends ends_of(const SlabMaps& maps, const SearchReach& reach) {
  Ends ends;
  const std::size_t slabs = maps.match.size();
  const auto slab_from = [&](double t) {  // the first whose middle lies there or further on
    std::size_t slab = 0;
    while (slab < slabs && maps.t(slab) < t) ++slab;
    return slab;
  };
  for (std::size_t n = 0; n < kStarts; ++n) {
    ends.starts_mm[n] = -std::max(-maps.t_min, 0.0) * static_cast<double>(n) / (kStarts - 1);
    ends.starts[n] = slab_from(ends.starts_mm[n] - 0.5 * kSlab_mm);
  }
  ends.first = slab_from(reach.depth_min_mm - 0.5 * kSlab_mm);
  while (ends.last < slabs && maps.t(ends.last) + 0.5 * kSlab_mm <= reach.depth_max_mm) ++ends.last;
  return ends;
}

// The best end of a line; no better than `best` where none gains more.
LineFit best_tip(const SlabMaps& maps, const Rows& rows, const std::vector<int>& columns, const Ends& ends,
                 double loss_least, LineFit best) {
  double match = 0.0, energy = 0.0;
  std::array<double, kStarts> match_before{}, energy_before{};
  for (std::size_t slab = 0; slab < ends.last; ++slab) {
    for (std::size_t n = 0; n < kStarts; ++n)
      if (ends.starts[n] == slab) match_before[n] = match, energy_before[n] = energy;
    if (rows[slab] == nullptr || columns[slab] < 0) continue;
    const cv::Vec2f& sums = rows[slab][columns[slab]];
    match += static_cast<double>(sums[0]), energy += static_cast<double>(sums[1]);
    // An end behind what tells against a void is no better than one before it.
    if (slab < ends.first || (sums[0] <= 0.0f && slab > ends.first)) continue;
    for (std::size_t n = 0; n < kStarts; ++n) {
      if (ends.starts[n] > slab) continue;
      const double m = match - match_before[n], e = energy - energy_before[n];
      // No loss gains more than match^2 / energy.
      if (m <= 0.0 || e <= 0.0 || m * m <= best.gain * e) continue;
      const double loss = std::clamp(m / e, loss_least, kLossMost), gain = loss * (2.0 * m - loss * e);
      if (gain > best.gain) best = {gain, loss, ends.starts_mm[n], maps.t(slab) + 0.5 * kSlab_mm};
    }
  }
  return best;
}

// What a disc of one radius sees, about every cell.
struct DiscSums {
  double radius_mm = 0.0, inflation = 1.0;
  SlabMaps maps;
  std::vector<cv::Mat> match_energy;  // the maps' two values beside each other
};

DiscSums disc_sums(const Corridor& corridor, const SearchReach& reach, double radius_mm) {
  const double cell = cell_mm(radius_mm);
  DiscSums sums{
      radius_mm, 1.0, disc_maps(point_maps(corridor, cell), disc_kernel(corridor, radius_mm, cell)), {}};
  // Further out, discs reach beyond the corridor.
  sums.inflation = inflation_of(sums.maps, reach.beside_mm + 4.0, corridor.radius_mm - radius_mm);
  sums.match_energy.resize(sums.maps.match.size());
  for (std::size_t slab = 0; slab < sums.match_energy.size(); ++slab)
    cv::merge(std::vector<cv::Mat>{sums.maps.match[slab], sums.maps.energy[slab]}, sums.match_energy[slab]);
  return sums;
}

LineCandidate best_line(const DiscSums& sums, const SearchReach& reach, const Ends& ends, double loss_least) {
  const SlabMaps& maps = sums.maps;
  LineCandidate top;
  top.inflation = sums.inflation;
  const double step = std::max(maps.cell_mm, 0.5 * sums.radius_mm);
  const int n = static_cast<int>(std::ceil(reach.beside_mm / step));
  const int tilts = static_cast<int>(std::floor(reach.tilt_deg / kTiltStep_deg));
  const double slope = std::tan(kTiltStep_deg * std::numbers::pi / 180.0);
  std::vector<std::vector<int>> cells;
  for (int i = -n; i <= n; ++i)
    for (int a = -tilts; a <= tilts; ++a) cells.push_back(cells_along(maps, i * step, a * slope));
  const auto along = [&](int i, int a) -> const std::vector<int>& {
    return cells[static_cast<std::size_t>((i + n) * (2 * tilts + 1) + a + tilts)];
  };
  for (int j = -n; j <= n; ++j)
    for (int b = -tilts; b <= tilts; ++b) {
      Rows rows;
      for (std::size_t slab = 0; slab < maps.match.size(); ++slab)
        rows.push_back(along(j, b)[slab] < 0 ? nullptr
                                             : sums.match_energy[slab].ptr<cv::Vec2f>(along(j, b)[slab]));
      for (int i = -n; i <= n; ++i)
        for (int a = -tilts; a <= tilts; ++a) {
          if (i * i + j * j > n * n || a * a + b * b > tilts * tilts) continue;
          const LineFit fit = best_tip(maps, rows, along(i, a), ends, loss_least, top.fit);
          if (fit.gain > top.fit.gain)
            top.line = {i * step, j * step, a * slope, b * slope, sums.radius_mm}, top.fit = fit;
        }
    }
  return top;
}

}  // namespace

std::vector<LineCandidate> line_candidates(const Corridor& corridor, const SearchReach& reach) {
  std::vector<DiscSums> discs;
  for (double radius : kRadii) discs.push_back(disc_sums(corridor, reach, radius));
  const Ends ends = ends_of(discs.front().maps, reach);
  const auto losing = [&](double loss_least) {
    std::vector<LineCandidate> lines;
    for (const DiscSums& disc : discs) lines.push_back(best_line(disc, reach, ends, loss_least));
    std::stable_sort(lines.begin(), lines.end(),
                     [](const LineCandidate& a, const LineCandidate& b) { return a.worth() > b.worth(); });
    return lines;
  };
  // A wide place that is a little darker can outweigh a thin void that is black, and is no needle.
  constexpr double kNeedleLoses = 0.5;
  std::vector<LineCandidate> needles = losing(kNeedleLoses);
  return needles.front().fit.gain > 0.0 ? needles : losing(0.0);
}

}  // namespace biopsy::imaging
