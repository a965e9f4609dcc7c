#include "planner/imaging/registration/local_motion.hpp"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "planner/imaging/registration/brightness.hpp"
#include "robot/common/statistics.hpp"

namespace biopsy::imaging {
namespace {

std::vector<float> moved(const Sampler& before, const TissueMotion& motion, const Grid& grid,
                         const std::vector<VoxelRow>& rows) {
  std::vector<float> values;
  values.reserve(voxel_count(rows));
  for_each_voxel(rows, grid, [&](const GridVoxel& voxel) {
    values.push_back(static_cast<float>(before.at(motion.before(voxel.p_S))));
  });
  return values;
}

// A voxel of the lattice's reach that the mask leaves, and how bright what is expected is there.
struct LatticePlace {
  Point p_S;
  DisplacementField::Nodes nodes;
  double after, slope, offset;
};

std::vector<LatticePlace> places_of(const Volume& after, const std::vector<VoxelRow>& rows,
                                    const BrightnessMap& map, const NeedleMask& mask,
                                    const DisplacementField& field) {
  const Sampler slope(map.slope), offset(map.offset);
  std::vector<LatticePlace> places;
  LatticePlace place;
  for_each_voxel(rows, after.grid, [&](const GridVoxel& voxel) {
    if (!field.nodes_at(voxel.p_S, place.nodes) || mask.covers(voxel.p_S)) return;
    place.p_S = voxel.p_S;
    place.after = static_cast<double>(after.voxels[voxel.n]);
    place.slope = slope.at(voxel.p_S), place.offset = offset.at(voxel.p_S);
    places.push_back(place);
  });
  return places;
}

// One stack of the after image at one scale: where it is compared, and how bright what is expected is there.
struct Compared {
  std::vector<LatticePlace> places;
  double alike;  // voxels that err together, for they were smoothed: so many count as one
};

Compared compared(Volume after, const Sampler& before, const TissueMotion& motion, const NeedleMask& mask,
                  double sigma_mm) {
  const std::vector<VoxelRow> rows = all_rows(after.grid);
  const BrightnessMap map = learn_brightness(after, rows, moved(before, motion, after.grid, rows), mask);
  // White noise, smoothed: the noise of places nearer than 2 sqrt(pi) sigma is one.
  const double one_mm = 2.0 * std::sqrt(std::numbers::pi) * sigma_mm;
  const double alike = (one_mm / after.grid.spacing_mm().array()).max(1.0).prod();
  return {places_of(after, rows, map, mask, motion.local), alike};
}

class LocalFit {
 public:
  LocalFit(const Sampler& before, const std::vector<Compared>& stacks, const LocalMotionSettings& settings)
      : before_(before), stacks_(stacks), settings_(settings) {}

  void improve(TissueMotion& motion) const {
    const auto count = 3 * static_cast<Eigen::Index>(motion.local.displacements().size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    for (const Compared& stack : stacks_) add_data(stack, motion, normal, right);
    add_prior(motion.local, normal, right);
    // Few nodes are neighbours: most of the matrix is zero.
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal.sparseView());
    const Eigen::VectorXd step = solver.solve(right);
    if (solver.info() != Eigen::Success || !step.allFinite()) return;
    std::vector<Eigen::Vector3d>& all = motion.local.displacements();
    for (std::size_t n = 0; n < all.size(); ++n) all[n] += step.segment<3>(3 * static_cast<Eigen::Index>(n));
  }

 private:
  void add_data(const Compared& stack, const TissueMotion& motion, Eigen::MatrixXd& normal,
                Eigen::VectorXd& right) const {
    struct Found {
      const LatticePlace* place;
      double error;
      Eigen::Vector3d gradient;
    };
    std::vector<Found> all;
    std::vector<double> sizes;
    for (const LatticePlace& place : stack.places) {
      double value;
      Found found{&place, 0.0, {}};
      const Point p_before = motion.X_before_after * place.p_S + motion.local.at(place.nodes);
      if (!before_.at(p_before, value, found.gradient)) continue;
      found.error = place.after - place.offset - place.slope * value;
      found.gradient *= place.slope;
      if (std::isnan(found.error)) continue;
      all.push_back(found);
      sizes.push_back(std::abs(found.error));
    }
    if (sizes.size() < 100) return;
    const double sigma = std::max(kMadToSigma * median(std::move(sizes)), 1e-9), limit = 4.685 * sigma;
    const double worth = 1.0 / (sigma * sigma * stack.alike);
    for (const Found& one : all) {
      if (std::abs(one.error) >= limit) continue;
      const double ratio = one.error / limit, left = 1.0 - ratio * ratio, weight = worth * left * left;
      const Eigen::Matrix3d square = weight * one.gradient * one.gradient.transpose();
      const DisplacementField::Nodes& nodes = one.place->nodes;
      for (int a = 0; a < 8; ++a) {
        const auto row = 3 * static_cast<Eigen::Index>(nodes.node[a]);
        right.segment<3>(row) += weight * one.error * nodes.weight[a] * one.gradient;
        for (int b = 0; b <= a; ++b)
          normal.block<3, 3>(row, 3 * static_cast<Eigen::Index>(nodes.node[b])) +=
              nodes.weight[a] * nodes.weight[b] * square;
      }
    }
  }

  void add_prior(const DisplacementField& field, Eigen::MatrixXd& normal, Eigen::VectorXd& right) const {
    const double stiff = 1.0 / std::pow(settings_.strain * settings_.spacing_mm, 2),
                 still = 1.0 / std::pow(settings_.reach_mm, 2);
    const Eigen::Vector3i& size = field.size();
    const auto tie = [&](int a, int b) {
      const Eigen::Vector3d apart = field.displacements()[static_cast<std::size_t>(a)] -
                                    field.displacements()[static_cast<std::size_t>(b)];
      normal.block<3, 3>(3 * a, 3 * a).diagonal().array() += stiff;
      normal.block<3, 3>(3 * b, 3 * b).diagonal().array() += stiff;
      normal.block<3, 3>(3 * std::max(a, b), 3 * std::min(a, b)).diagonal().array() -= stiff;
      right.segment<3>(3 * a) -= stiff * apart;
      right.segment<3>(3 * b) += stiff * apart;
    };
    for (int k = 0; k < size.z(); ++k)
      for (int j = 0; j < size.y(); ++j)
        for (int i = 0; i < size.x(); ++i) {
          const int n = field.node(i, j, k);
          normal.block<3, 3>(3 * n, 3 * n).diagonal().array() += still;
          right.segment<3>(3 * n) -= still * field.displacements()[static_cast<std::size_t>(n)];
          if (i + 1 < size.x()) tie(n, field.node(i + 1, j, k));
          if (j + 1 < size.y()) tie(n, field.node(i, j + 1, k));
          if (k + 1 < size.z()) tie(n, field.node(i, j, k + 1));
        }
  }

  const Sampler& before_;
  const std::vector<Compared>& stacks_;
  const LocalMotionSettings& settings_;
};

}  // namespace

DisplacementField::DisplacementField(const NeedleFrame& frame, double from_mm, double to_mm, double radius_mm,
                                     double spacing_mm)
    : frame_(frame), per_mm_(1.0 / spacing_mm) {
  const int along = static_cast<int>(std::ceil(std::max(to_mm - from_mm, 1.0) / spacing_mm)) + 1;
  const int half = static_cast<int>(std::ceil(radius_mm / spacing_mm));
  size_ = {along, 2 * half + 1, 2 * half + 1};
  low_ = {0.5 * (from_mm + to_mm - (along - 1) * spacing_mm), -half * spacing_mm, -half * spacing_mm};
  displacements_.assign(static_cast<std::size_t>(size_.prod()), Eigen::Vector3d::Zero());
}

DisplacementField register_local(const Volume& before, std::span<const Volume> after,
                                 const RigidTransform& X_before_after, const NeedleMask& mask,
                                 const LocalMotionSettings& settings) {
  TissueMotion motion{X_before_after, DisplacementField(mask.frame, settings.from_mm, settings.to_mm,
                                                        settings.radius_mm, settings.spacing_mm)};
  // What surrounds the path, and where it was before.
  constexpr double kAbout_mm = 5.0, kDisplacedMost_mm = 10.0;
  const Point from = mask.frame.point(settings.from_mm, 0, 0), to = mask.frame.point(settings.to_mm, 0, 0);
  Box about{from, from}, about_before{X_before_after * from, X_before_after * from};
  for (const Point& end : {from, to}) {
    about.include(end, settings.radius_mm + kAbout_mm);
    about_before.include(X_before_after * end, settings.radius_mm + kAbout_mm + kDisplacedMost_mm);
  }
  for (const double sigma_mm : {1.5, 0.7}) {
    const Volume smooth = smoothed_coarse(before, about_before, sigma_mm);
    const Sampler sampler(smooth);
    std::vector<Compared> stacks;
    for (const Volume& stack : after) {
      const Volume part = smoothed_coarse(stack, about, sigma_mm);
      if (part.voxels.empty()) continue;
      stacks.push_back(compared(thinned(part, 2.5 * sigma_mm), sampler, motion, mask, sigma_mm));
    }
    const LocalFit fit(sampler, stacks, settings);
    for (int n = 0; n < 3; ++n) fit.improve(motion);
  }
  return motion.local;
}

}  // namespace biopsy::imaging
