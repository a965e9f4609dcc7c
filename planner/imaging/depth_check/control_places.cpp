#include "planner/imaging/depth_check/control_places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace biopsy::imaging {
namespace {

constexpr std::size_t kPlacesMax = 160;
constexpr double kAlongMost_mm = 8.0;    // how far a control place may lie ahead of or behind the needle's
constexpr double kBesideMost_mm = 22.0;  // and beside
constexpr double kKnown = 0.8;           // of what the fit is told must be told there as well
constexpr double kNegligible = 0.02;     // a stack that tells less is not asked

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

// The corridor's voxel that lies `shift` from this one of the same stack; none: nullptr.
const CorridorVoxel* voxel_at(const Corridor& corridor, const Stack& stack, std::uint32_t cell,
                              const Shift& shift) {
  const auto n = static_cast<int>(cell);
  const Eigen::Vector3i at =
      shift + Eigen::Vector3i(n % stack.size.x(), (n / stack.size.x()) % stack.size.y(),
                              n / (stack.size.x() * stack.size.y()));
  if ((at.array() < 0).any() || (at.array() >= stack.size.array()).any()) return nullptr;
  const auto row = static_cast<std::size_t>(at.y() + stack.size.y() * at.z());
  const auto sought = static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(stack.size.x()) +
                      static_cast<std::uint32_t>(at.x());
  const CorridorVoxel* const first = corridor.voxels.data() + stack.rows[row];
  const CorridorVoxel* const end = corridor.voxels.data() + stack.rows[row + 1];
  if (first == end || sought < first->cell) return nullptr;
  // Few rows have a gap: it lies as far from the first voxel as its number tells, or a little nearer.
  const CorridorVoxel* voxel = first + std::min<std::ptrdiff_t>(sought - first->cell, end - first - 1);
  while (voxel->cell > sought) --voxel;
  return voxel->cell == sought ? voxel : nullptr;
}

}  // namespace

ControlPlaces at_control_places(const Corridor& corridor, const std::vector<TemplateVoxel>& fitted,
                                const VoidMatrix& step_for, const VoidFit& fit, double clip,
                                double clear_mm) {
  ControlPlaces result;
  const auto in_void = [&](const CorridorVoxel& voxel) {
    const double t = static_cast<double>(voxel.t);
    if (t > fit.depth_mm + clear_mm + 0.5 * corridor.along_mm) return false;
    const double du = static_cast<double>(voxel.u) - fit.line.u - fit.line.u_slope * t,
                 dv = static_cast<double>(voxel.v) - fit.line.v - fit.line.v_slope * t;
    return du * du + dv * dv <= clear_mm * clear_mm;
  };
  // What is left over, in standard deviations.
  const auto left = [&](const CorridorVoxel& voxel) {
    const double z = static_cast<double>(voxel.measured - voxel.predicted) /
                     std::sqrt(static_cast<double>(voxel.variance));
    return std::clamp(z, -clip, clip);
  };
  double squares = 0.0, told_by_all = 0.0;
  std::size_t voxels = 0;
  // What the fit is told, each parameter counted by how well it is known.
  const VoidVector scale = step_for.diagonal();
  const auto told = [&](const TemplateVoxel& one) { return scale.dot(one.slope.cwiseProduct(one.slope)); };
  for (const TemplateVoxel& one : fitted) told_by_all += told(one);
  // Stacks err on their own: their errors' second moments add up.
  result.count = std::numeric_limits<std::size_t>::max();
  for (std::uint32_t s = 0; s < corridor.stacks.size(); ++s) {
    const Stack& stack = corridor.stacks[s];
    double told_by_stack = 0.0;
    for (const TemplateVoxel& one : fitted)
      if (corridor.voxels[one.voxel].stack == s) told_by_stack += told(one);
    if (told_by_stack <= kNegligible * told_by_all) continue;
    VoidMatrix moment = VoidMatrix::Zero();
    double loss_alone = 0.0;
    std::size_t count = 0;
    const std::vector<Shift> shifts = shifts_of(stack, clear_mm + fit.line.radius_mm + fit.soft_mm);
    const std::size_t every = shifts.size() / kPlacesMax + 1;
    for (std::size_t n = 0; n < shifts.size(); n += every) {
      VoidVector answer = VoidVector::Zero();
      double told_there = 0.0;
      for (const TemplateVoxel& one : fitted) {
        const CorridorVoxel& voxel = corridor.voxels[one.voxel];
        if (voxel.stack != s) continue;
        const CorridorVoxel* const there = voxel_at(corridor, stack, voxel.cell, shifts[n]);
        if (there == nullptr || in_void(*there)) continue;
        const double z = left(*there);
        told_there += told(one);
        answer += z * one.slope;
        squares += z * z, ++voxels;
      }
      if (!(told_there >= kKnown * told_by_stack)) continue;
      const VoidVector error = step_for * answer;
      moment += error * error.transpose();
      loss_alone += answer[kLoss] * answer[kLoss];
      ++count;
    }
    if (count > 0) {
      result.covariance += moment / static_cast<double>(count);
      result.loss_alone += loss_alone / static_cast<double>(count);
    }
    result.count = std::min(result.count, count);
  }
  if (told_by_all <= 0.0) result.count = 0;
  if (voxels > 0) result.mean_square = squares / static_cast<double>(voxels);
  return result;
}

}  // namespace biopsy::imaging
