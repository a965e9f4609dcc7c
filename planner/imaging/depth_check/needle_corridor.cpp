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

Eigen::Vector3i thin_stride(const Grid& grid) {
  return (kThin_mm / grid.spacing_mm().array()).round().max(1.0).cast<int>();
}

// Square of its distance from the expected axis.
double beside_needle(const CorridorVoxel& voxel) {
  return static_cast<double>(voxel.u * voxel.u + voxel.v * voxel.v);
}

// Of one stack's voxels, from `first` on. Noise from the flatter half of the tissue beside the needle, the
// registration error from the steep quarter; the error of interpolation is known of each voxel. The thinned
// voxels are enough to learn from.
void learn_noise(const std::vector<float>& steepness, const std::vector<float>& interpolation,
                 double needle_mm, std::size_t first, Corridor& corridor) {
  std::vector<float> slopes, flat, steep, steep_slopes, values;
  const auto begin = std::lower_bound(corridor.thinned.begin(), corridor.thinned.end(), first);
  for (auto n = begin; n != corridor.thinned.end(); ++n) slopes.push_back(steepness[*n - first]);
  if (slopes.empty()) return;
  const float half = order_statistic(slopes, slopes.size() / 2),
              quarter = order_statistic(slopes, slopes.size() * 3 / 4);
  for (auto n = begin; n != corridor.thinned.end(); ++n) {
    const CorridorVoxel& voxel = corridor.voxels[*n];
    const float slope = steepness[*n - first], change = std::abs(voxel.measured - voxel.predicted);
    values.push_back(voxel.predicted);
    if (beside_needle(voxel) < needle_mm * needle_mm) continue;
    if (slope <= half) flat.push_back(change);
    if (slope >= quarter) steep.push_back(change), steep_slopes.push_back(slope);
  }
  const auto middle_of = [](std::vector<float>& of) {
    return of.empty() ? 0.0 : static_cast<double>(median(std::move(of)));
  };
  const double noise = std::max(kMadToSigma * middle_of(flat), 1e-3 * std::abs(middle_of(values)) + 1e-9);
  const double rest = std::pow(kMadToSigma * middle_of(steep), 2) - noise * noise;
  const double slope2 = std::pow(middle_of(steep_slopes), 2);
  // The registration error that explains what is left where the image is steep.
  const double misfit_mm = slope2 > 0.0 ? std::sqrt(std::max(rest, 0.0) / slope2) : 0.0;
  for (std::size_t n = 0; n < steepness.size(); ++n) {
    CorridorVoxel& voxel = corridor.voxels[first + n];
    const double model = kModelError * static_cast<double>(voxel.predicted),
                 misfit = misfit_mm * static_cast<double>(steepness[n]);
    voxel.variance = static_cast<float>(noise * noise + misfit * misfit + model * model) +
                     interpolation[n] * interpolation[n];
  }
}

// Where the before image tells less (another contrast, motion of its own) its errors are larger all around: a
// variance of the whole corridor would let such places outweigh a needle. From the tissue beside it, by cell:
// it varies slowly.
void vary_noise(const Grid& grid, double needle_mm, const Stack& stack, Corridor& corridor) {
  constexpr double kReach_mm = 12.0;  // wider than the needle's surroundings, which are not asked
  constexpr float kSquareMost = 16.0f, kLeast = 0.25f;
  const Eigen::Vector3i side = thin_stride(grid);
  Volume squares;
  squares.grid = grid_of_cells(grid, side);
  squares.voxels.assign(squares.grid.voxel_count(), 0.0f);
  Volume one = squares;
  const auto each = [&](const auto& use) {
    for (int k = 0, row = 0; k < grid.size.z(); ++k)
      for (int j = 0; j < grid.size.y(); ++j, ++row) {
        const std::size_t cells = squares.grid.index(0, j / side.y(), k / side.z());
        const auto begin = static_cast<std::uint32_t>(grid.index(0, j, k)),
                   wide = static_cast<std::uint32_t>(side.x());
        for (std::uint32_t n = stack.rows[row]; n < stack.rows[row + 1]; ++n)
          use(corridor.voxels[n], cells + (corridor.voxels[n].cell - begin) / wide);
      }
  };
  const float share = 1.0f / static_cast<float>(side.prod());
  each([&](const CorridorVoxel& voxel, std::size_t cell) {
    if (beside_needle(voxel) < needle_mm * needle_mm) return;
    const float change = voxel.measured - voxel.predicted;
    one.voxels[cell] += share;
    squares.voxels[cell] += share * std::min(change * change / voxel.variance, kSquareMost);
  });
  one = box_averaged(std::move(one), kReach_mm);
  squares = box_averaged(std::move(squares), kReach_mm);
  each([&](CorridorVoxel& voxel, std::size_t cell) {
    const float asked = one.voxels[cell];
    if (asked > 0.02f) voxel.variance *= std::max(squares.voxels[cell] / asked, kLeast);
  });
}

Stack stack_of(const Grid& grid, Corridor& corridor) {
  constexpr double kStep_mm = 0.7;  // about the radius of the thinnest void that can be seen
  const Eigen::Vector3d spacing = grid.spacing_mm();
  Stack stack;
  stack.size = grid.size;
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
  static_assert(kPlacesMost == 5 * 5 * 5);
  stack.places.resize(count.prod(), 3);
  int row = 0;
  each(count, [&](const Eigen::Vector3d& place) { stack.places.row(row++) = place.array().cast<float>(); });
  each(beside, [&](const Eigen::Vector3d& place) { stack.lateral.push_back(place.tail<2>()); });
  stack.reach_mm = static_cast<double>(stack.places.matrix().rowwise().norm().maxCoeff());
  return stack;
}

// One stack of the after image and what the before image says of it.
struct Predicted {
  const Volume* after;
  Prediction before;

  bool knows(const Point& p_S) const {  // of the voxel it lies in
    return before.knows((after->grid.X_SI.inverse() * p_S).array().round().cast<int>());
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
  const Grid& grid = after.grid;
  const Prediction& before = predicted.before;
  const std::size_t first = corridor.voxels.size(), most = before.value.size();
  const auto number = static_cast<std::uint32_t>(corridor.stacks.size());
  Stack stack = stack_of(grid, corridor);
  std::vector<float> steepness, interpolation;
  corridor.voxels.reserve(first + most), steepness.reserve(most), interpolation.reserve(most);
  const Eigen::Vector3i stride = thin_stride(grid);
  const NeedleMask path{corridor.frame, corridor.t_min, corridor.t_max, settings.radius_mm};
  for_each_voxel(before.rows, grid, [&](const GridVoxel& voxel) {
    const Eigen::Vector3d c = corridor.frame.coordinates(voxel.p_S);
    const float value = before.value[voxel.m];
    if (!path.covers_coordinates(c) || !std::isfinite(value)) return;
    const auto place = static_cast<std::uint32_t>(corridor.voxels.size());
    stack.rows.resize(static_cast<std::size_t>(voxel.j + grid.size.y() * voxel.k) + 1, place);
    if (voxel.i % stride.x() == 0 && voxel.j % stride.y() == 0 && voxel.k % stride.z() == 0)
      corridor.thinned.push_back(place);
    corridor.voxels.push_back({static_cast<float>(c.x()), static_cast<float>(c.y()),
                               static_cast<float>(c.z()), after.voxels[voxel.n], value, 1.0f, number,
                               static_cast<std::uint32_t>(voxel.n)});
    steepness.push_back(before.steepness[voxel.m]);
    interpolation.push_back(before.interpolation[voxel.m]);
  });
  stack.rows.resize(static_cast<std::size_t>(grid.size.y() * grid.size.z()) + 1,
                    static_cast<std::uint32_t>(corridor.voxels.size()));
  learn_noise(steepness, interpolation, settings.needle_mm, first, corridor);
  vary_noise(grid, settings.needle_mm, stack, corridor);
  corridor.stacks.push_back(std::move(stack));
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
