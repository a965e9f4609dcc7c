#include "planner/imaging/depth_check/needle_corridor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "planner/imaging/depth_check/prediction.hpp"
#include "robot/common/statistics.hpp"

namespace biopsy::imaging {
namespace {

constexpr double kThin_mm = 0.6;      // finer voxels are thinned for the search: a void is wider
constexpr double kModelError = 0.05;  // of a voxel's signal: contrast never matches better

// Of one stack's voxels, from `first` on. Noise from the flatter half of the tissue beside the needle, the
// registration error from the steep quarter; the error of interpolation is known of each voxel.
void learn_noise(const std::vector<float>& steepness, const std::vector<float>& interpolation,
                 double needle_mm, std::size_t first, Corridor& corridor) {
  if (steepness.empty()) return;
  std::vector<double> slopes(steepness.begin(), steepness.end()), flat, steep, squared, values;
  std::vector<double> sorted = slopes;
  std::sort(sorted.begin(), sorted.end());
  const double half = sorted[sorted.size() / 2], quarter = sorted[sorted.size() * 3 / 4];
  for (std::size_t n = 0; n < slopes.size(); ++n) {
    const CorridorVoxel& voxel = corridor.voxels[first + n];
    values.push_back(static_cast<double>(voxel.predicted));
    if (std::hypot(voxel.u, voxel.v) < static_cast<float>(needle_mm)) continue;
    const double change = std::abs(static_cast<double>(voxel.measured - voxel.predicted));
    if (slopes[n] <= half) flat.push_back(change);
    if (slopes[n] >= quarter) steep.push_back(change), squared.push_back(slopes[n] * slopes[n]);
  }
  const auto middle_of = [](const std::vector<double>& of) { return of.empty() ? 0.0 : median(of); };
  const double noise = std::max(kMadToSigma * middle_of(flat), 1e-3 * std::abs(middle_of(values)) + 1e-9);
  const double rest = std::pow(kMadToSigma * middle_of(steep), 2) - noise * noise;
  const double slope2 = middle_of(squared);
  // The registration error that explains what is left where the image is steep.
  const double misfit_mm = slope2 > 0.0 ? std::sqrt(std::max(rest, 0.0) / slope2) : 0.0;
  for (std::size_t n = 0; n < slopes.size(); ++n) {
    CorridorVoxel& voxel = corridor.voxels[first + n];
    const double model = kModelError * static_cast<double>(voxel.predicted);
    voxel.variance = static_cast<float>(noise * noise + std::pow(misfit_mm * slopes[n], 2) + model * model) +
                     interpolation[n] * interpolation[n];
  }
}

// Where the before image tells less (another contrast, motion of its own) its errors are larger all around: a
// variance of the whole corridor would let such places outweigh a needle. From the tissue beside it.
void vary_noise(const Grid& grid, double needle_mm, std::size_t first, Corridor& corridor) {
  constexpr double kReach_mm = 12.0;  // wider than the needle's surroundings, which are not asked
  constexpr float kSquareMost = 16.0f, kLeast = 0.25f;
  Volume squares;
  squares.grid = grid;
  squares.voxels.assign(grid.voxel_count(), 0.0f);
  Volume one = squares;
  for (std::size_t n = first; n < corridor.voxels.size(); ++n) {
    const CorridorVoxel& voxel = corridor.voxels[n];
    if (std::hypot(voxel.u, voxel.v) < static_cast<float>(needle_mm)) continue;
    const float change = voxel.measured - voxel.predicted;
    one.voxels[voxel.cell] = 1.0f;
    squares.voxels[voxel.cell] = std::min(change * change / voxel.variance, kSquareMost);
  }
  one = box_averaged(std::move(one), kReach_mm);
  squares = box_averaged(std::move(squares), kReach_mm);
  for (std::size_t n = first; n < corridor.voxels.size(); ++n) {
    CorridorVoxel& voxel = corridor.voxels[n];
    const float asked = one.voxels[voxel.cell];
    if (asked > 0.02f) voxel.variance *= std::max(squares.voxels[voxel.cell] / asked, kLeast);
  }
}

Stack stack_of(const Grid& grid, Corridor& corridor) {
  constexpr double kStep_mm = 0.7;  // about the radius of the thinnest void that can be seen
  const Eigen::Vector3d spacing = grid.spacing_mm();
  Stack stack;
  stack.size = grid.size;
  stack.voxel_at.assign(grid.voxel_count(), -1);
  Eigen::Matrix3d& sides = stack.steps;
  Eigen::Vector3i count, beside;
  for (int a = 0; a < 3; ++a) {
    const Eigen::Vector3d side = grid.X_SI.linear().col(a);
    sides.col(a) << side.dot(corridor.frame.along), side.dot(corridor.frame.across),
        side.dot(corridor.frame.up);
    count[a] = std::clamp(static_cast<int>(std::ceil(spacing[a] / kStep_mm)), 1, 5);
    beside[a] = std::clamp(static_cast<int>(std::ceil(sides.col(a).tail<2>().norm() / kStep_mm)), 1, 5);
  }
  const double along_mm = sides.row(0).cwiseAbs().sum();
  corridor.along_mm = corridor.stacks.empty() ? along_mm : std::min(corridor.along_mm, along_mm);
  const auto each = [&](const Eigen::Vector3i& n, const auto& add) {
    for (int k = 0; k < n.z(); ++k)
      for (int j = 0; j < n.y(); ++j)
        for (int i = 0; i < n.x(); ++i)
          add(sides * ((Eigen::Vector3d(i, j, k).array() + 0.5) / n.cast<double>().array() - 0.5).matrix());
  };
  each(count, [&](const Eigen::Vector3d& place) { stack.places.push_back(place); });
  each(beside, [&](const Eigen::Vector3d& place) { stack.lateral.push_back(place.tail<2>()); });
  return stack;
}

// One stack of the after image and what the before image says of it.
struct Predicted {
  const Volume* after;
  Prediction before;

  bool knows(const Point& p_S) const {
    const Grid& grid = after->grid;
    const Eigen::Vector3i index =
        (grid.X_SI.inverse() * p_S).array().round().cast<int>();  // the voxel it lies in
    return grid.contains(index.x(), index.y(), index.z()) &&
           std::isfinite(before.value.at(index.x(), index.y(), index.z()));
  }
};

void find_coverage(const std::vector<Predicted>& stacks, const CorridorSettings& s, Corridor& corridor) {
  const auto covered = [&](double t) {
    return std::any_of(stacks.begin(), stacks.end(),
                       [&](const Predicted& stack) { return stack.knows(corridor.frame.point(t, 0, 0)); });
  };
  constexpr double kStep_mm = 0.25;
  double start =
      s.from_mm;  // where the entry itself lies outside, the path begins where it enters the images
  while (start < s.to_mm && !covered(start)) start += kStep_mm;
  corridor.t_min = corridor.t_max = start;
  while (corridor.t_max + kStep_mm <= s.to_mm && covered(corridor.t_max + kStep_mm))
    corridor.t_max += kStep_mm;
}

void add_stack(const Predicted& predicted, const CorridorSettings& settings, Corridor& corridor) {
  const Volume& after = *predicted.after;
  const std::size_t first = corridor.voxels.size();
  const auto number = static_cast<std::uint32_t>(corridor.stacks.size());
  corridor.stacks.push_back(stack_of(after.grid, corridor));
  std::vector<float> steepness, interpolation;
  const Eigen::Array3i stride = (kThin_mm / after.grid.spacing_mm().array()).round().max(1.0).cast<int>();
  std::size_t n = 0;
  for (int k = 0; k < after.grid.size.z(); ++k)
    for (int j = 0; j < after.grid.size.y(); ++j)
      for (int i = 0; i < after.grid.size.x(); ++i, ++n) {
        const Eigen::Vector3d c = corridor.frame.coordinates(after.grid.X_SI * Eigen::Vector3d(i, j, k));
        const bool inside = c.x() >= corridor.t_min && c.x() <= corridor.t_max &&
                            std::hypot(c.y(), c.z()) <= settings.radius_mm;
        const float before = predicted.before.value.voxels[n];
        if (!inside || !std::isfinite(before)) continue;
        const bool kept = i % stride.x() == 0 && j % stride.y() == 0 && k % stride.z() == 0;
        corridor.stacks.back().voxel_at[n] = static_cast<std::int32_t>(corridor.voxels.size());
        if (kept) corridor.thinned.push_back(static_cast<std::uint32_t>(corridor.voxels.size()));
        corridor.voxels.push_back({static_cast<float>(c.x()), static_cast<float>(c.y()),
                                   static_cast<float>(c.z()), after.voxels[n], before, 1.0f, number,
                                   static_cast<std::uint32_t>(n)});
        steepness.push_back(predicted.before.steepness.voxels[n]);
        interpolation.push_back(predicted.before.interpolation.voxels[n]);
      }
  learn_noise(steepness, interpolation, settings.needle_mm, first, corridor);
  vary_noise(after.grid, settings.needle_mm, first, corridor);
}

}  // namespace

Corridor needle_corridor(const Volume& before, std::span<const Volume> after,
                         const RegistrationResult& motion, const NeedleFrame& frame,
                         const CorridorSettings& settings) {
  Corridor corridor;
  corridor.frame = frame;
  corridor.radius_mm = settings.radius_mm;
  constexpr double kMargin_mm = 5.0;  // of what surrounds the corridor, to match brightness
  const NeedleMask mask{frame, settings.from_mm, settings.to_mm, settings.needle_mm},
      reach{frame, settings.from_mm - kMargin_mm, settings.to_mm + kMargin_mm,
            settings.radius_mm + kMargin_mm};
  TissueMotion tissue{motion.X_after_before.inverse(), {}};
  if (motion.points > 0)
    tissue.local = register_local(
        before, after, tissue.X_before_after, mask,
        {.from_mm = settings.from_mm, .to_mm = settings.to_mm, .radius_mm = settings.radius_mm});
  std::vector<Predicted> stacks;
  for (const Volume& stack : after) {
    if (stack.voxels.empty() || before.voxels.empty()) continue;
    stacks.push_back({&stack, predicted(before, stack, tissue, mask, reach)});
  }
  find_coverage(stacks, settings, corridor);
  for (const Predicted& stack : stacks) add_stack(stack, settings, corridor);
  if (corridor.voxels.size() < 100) corridor.voxels.clear();
  return corridor;
}

}  // namespace biopsy::imaging
