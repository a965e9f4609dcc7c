#include "planner/imaging/depth_check/control_places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace biopsy::imaging {
namespace {

constexpr std::size_t kPlacesMax = 160;
constexpr double kAlongMost_mm = 8.0;    // how far a control place may lie ahead of or behind the needle's
constexpr double kBesideMost_mm = 22.0;  // and beside
constexpr double kKnown = 0.8;           // of what the fit knows about the depth must be known there as well

using Shift = Eigen::Vector3i;

// Whole voxels, so that nothing is interpolated and what is left over keeps its likeness between neighbours.
std::vector<Shift> shifts_of(const Stack& stack, double nearest_mm) {
  std::vector<Shift> all;
  const Eigen::Vector3d spacing = stack.steps.colwise().norm();
  const Eigen::Vector3i reach = ((kBesideMost_mm + kAlongMost_mm) / spacing.array()).floor().cast<int>();
  const Eigen::Vector3i last = reach.cwiseMin(stack.size - Eigen::Vector3i::Ones());
  // About a millimetre and a half apart: nearer ones tell the same.
  const Eigen::Vector3i stride = (1.5 / spacing.array()).round().max(1.0).cast<int>();
  for (int k = -(last.z() / stride.z()) * stride.z(); k <= last.z(); k += stride.z())
    for (int j = -(last.y() / stride.y()) * stride.y(); j <= last.y(); j += stride.y())
      for (int i = -(last.x() / stride.x()) * stride.x(); i <= last.x(); i += stride.x()) {
        const Eigen::Vector3d moved = stack.steps * Eigen::Vector3d(i, j, k);
        const double beside = std::hypot(moved.y(), moved.z());
        if (std::abs(moved.x()) <= kAlongMost_mm && beside >= nearest_mm && beside <= kBesideMost_mm)
          all.emplace_back(i, j, k);
      }
  return all;
}

}  // namespace

ControlPlaces at_control_places(const Corridor& corridor, const std::vector<TemplateVoxel>& fitted,
                                const VoidMatrix& step_for, const VoidFit& fit, double clip,
                                double clear_mm) {
  ControlPlaces result;
  // What is left over, in standard deviations; NaN in the void.
  std::vector<float> left(corridor.voxels.size());
  for (std::size_t n = 0; n < left.size(); ++n) {
    const CorridorVoxel& voxel = corridor.voxels[n];
    const double t = static_cast<double>(voxel.t);
    const double beside = std::hypot(static_cast<double>(voxel.u) - fit.line.u - fit.line.u_slope * t,
                                     static_cast<double>(voxel.v) - fit.line.v - fit.line.v_slope * t);
    const bool clear = beside > clear_mm || t > fit.depth_mm + clear_mm + 0.5 * corridor.along_mm;
    const double z = static_cast<double>(voxel.measured - voxel.predicted) /
                     std::sqrt(static_cast<double>(voxel.variance));
    left[n] =
        clear ? static_cast<float>(std::clamp(z, -clip, clip)) : std::numeric_limits<float>::quiet_NaN();
  }
  double known_to_fit = 0.0;
  for (const TemplateVoxel& one : fitted) known_to_fit += one.slope[kDepth] * one.slope[kDepth];
  double squares = 0.0;
  std::size_t voxels = 0;
  // A shift moves every stack's voxels alike in whole steps of the first.
  const std::vector<Shift> shifts =
      shifts_of(corridor.stacks.front(), clear_mm + fit.line.radius_mm + fit.soft_mm);
  const std::size_t every = shifts.size() / kPlacesMax + 1;
  for (std::size_t s = 0; s < shifts.size(); s += every) {
    VoidVector answer = VoidVector::Zero();
    double known = 0.0;
    for (const TemplateVoxel& one : fitted) {
      const CorridorVoxel& voxel = corridor.voxels[one.voxel];
      const Stack& stack = corridor.stacks[voxel.stack];
      const auto cell = static_cast<int>(voxel.cell);
      const Eigen::Vector3i at =
          shifts[s] + Eigen::Vector3i(cell % stack.size.x(), (cell / stack.size.x()) % stack.size.y(),
                                      cell / (stack.size.x() * stack.size.y()));
      if ((at.array() < 0).any() || (at.array() >= stack.size.array()).any()) continue;
      const std::int32_t there = stack.voxel_at[static_cast<std::size_t>(
          at.x() + stack.size.x() * (at.y() + stack.size.y() * at.z()))];
      if (there < 0) continue;
      const float z = left[static_cast<std::size_t>(there)];
      if (std::isnan(z)) continue;
      known += one.slope[kDepth] * one.slope[kDepth];
      answer += static_cast<double>(z) * one.slope;
      squares += static_cast<double>(z * z), ++voxels;
    }
    if (!(known >= kKnown * known_to_fit)) continue;
    const VoidVector error = step_for * answer;
    result.covariance += error * error.transpose();
    ++result.count;
  }
  if (result.count > 0) result.covariance /= static_cast<double>(result.count);
  if (voxels > 0) result.mean_square = squares / static_cast<double>(voxels);
  return result;
}

}  // namespace biopsy::imaging
