#include "planner/imaging/registration/local_motion.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "planner/imaging/registration/brightness.hpp"
#include "robot/common/statistics.hpp"

namespace biopsy::imaging {
namespace {

// One stack of the after image at one scale: a lattice of places, and how bright what is expected is there.
struct Compared {
  Volume after, slope, offset;
  double alike;  // voxels that err together, for they were smoothed: so many count as one
};

Volume moved(const Sampler& before, const Grid& grid, const TissueMotion& motion, Volume onto) {
  for (int k = 0; k < grid.size.z(); ++k)
    for (int j = 0; j < grid.size.y(); ++j)
      for (int i = 0; i < grid.size.x(); ++i)
        onto.voxels[grid.index(i, j, k)] =
            static_cast<float>(before.at(motion.before(grid.X_SI * Eigen::Vector3d(i, j, k))));
  return onto;
}

Volume sampled(const Volume& cells, Volume onto) {
  const Sampler sampler(cells);
  std::size_t n = 0;
  for (int k = 0; k < onto.grid.size.z(); ++k)
    for (int j = 0; j < onto.grid.size.y(); ++j)
      for (int i = 0; i < onto.grid.size.x(); ++i, ++n)
        onto.voxels[n] = static_cast<float>(sampler.at(onto.grid.X_SI * Eigen::Vector3d(i, j, k)));
  return onto;
}

Compared compared(Volume after, const Sampler& before, const TissueMotion& motion, const NeedleMask& mask,
                  double sigma_mm) {
  const BrightnessMap map = learn_brightness(after, moved(before, after.grid, motion, after), mask);
  // White noise, smoothed: the noise of places nearer than 2 sqrt(pi) sigma is one.
  const double one_mm = 2.0 * std::sqrt(std::numbers::pi) * sigma_mm;
  const double alike = (one_mm / after.grid.spacing_mm().array()).max(1.0).prod();
  return {after, sampled(map.slope, after), sampled(map.offset, after), alike};
}

// Calls `use(place, index)` for voxels of the lattice's reach that the mask leaves.
template <class Use>
void for_each_place(const Volume& after, const NeedleMask& mask, const DisplacementField& field,
                    const Use& use) {
  DisplacementField::Nodes nodes;
  for (int k = 0; k < after.grid.size.z(); ++k)
    for (int j = 0; j < after.grid.size.y(); ++j)
      for (int i = 0; i < after.grid.size.x(); ++i) {
        const Point p_S = after.grid.X_SI * Eigen::Vector3d(i, j, k);
        if (!mask.covers(p_S) && field.nodes_at(p_S, nodes)) use(p_S, after.grid.index(i, j, k), nodes);
      }
}

class LocalFit {
 public:
  LocalFit(const Sampler& before, const std::vector<Compared>& stacks, const NeedleMask& mask,
           const LocalMotionSettings& settings)
      : before_(before), stacks_(stacks), mask_(mask), settings_(settings) {}

  void improve(TissueMotion& motion) const {
    const auto count = 3 * static_cast<Eigen::Index>(motion.local.displacements().size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    add_data(motion, normal, right);
    add_prior(motion.local, normal, right);
    const Eigen::VectorXd step = normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
    if (!step.allFinite()) return;
    std::vector<Eigen::Vector3d>& all = motion.local.displacements();
    for (std::size_t n = 0; n < all.size(); ++n) all[n] += step.segment<3>(3 * static_cast<Eigen::Index>(n));
  }

 private:
  double error_at(const Compared& stack, std::size_t index, double value) const {
    return static_cast<double>(stack.after.voxels[index]) - static_cast<double>(stack.offset.voxels[index]) -
           static_cast<double>(stack.slope.voxels[index]) * value;
  }

  void add_data(const TissueMotion& motion, Eigen::MatrixXd& normal, Eigen::VectorXd& right) const {
    for (const Compared& stack : stacks_) {
      std::vector<double> sizes;
      for_each_place(stack.after, mask_, motion.local,
                     [&](const Point& p_S, std::size_t index, const DisplacementField::Nodes&) {
                       const double value = before_.at(motion.before(p_S));
                       if (!std::isnan(value)) sizes.push_back(std::abs(error_at(stack, index, value)));
                     });
      if (sizes.size() < 100) continue;
      const double sigma = std::max(kMadToSigma * median(std::move(sizes)), 1e-9), limit = 4.685 * sigma;
      const double worth = 1.0 / (sigma * sigma * stack.alike);
      for_each_place(stack.after, mask_, motion.local,
                     [&](const Point& p_S, std::size_t index, const DisplacementField::Nodes& nodes) {
                       double value;
                       Eigen::Vector3d gradient;
                       if (!before_.at(motion.before(p_S), value, gradient)) return;
                       const double error = error_at(stack, index, value);
                       if (std::abs(error) >= limit) return;
                       const double weight = worth * std::pow(1.0 - std::pow(error / limit, 2), 2);
                       gradient *= static_cast<double>(stack.slope.voxels[index]);
                       const Eigen::Matrix3d square = weight * gradient * gradient.transpose();
                       for (int a = 0; a < 8; ++a) {
                         const auto row = 3 * static_cast<Eigen::Index>(nodes.node[a]);
                         right.segment<3>(row) += weight * error * nodes.weight[a] * gradient;
                         for (int b = 0; b <= a; ++b)
                           normal.block<3, 3>(row, 3 * static_cast<Eigen::Index>(nodes.node[b])) +=
                               nodes.weight[a] * nodes.weight[b] * square;
                       }
                     });
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
  const NeedleMask& mask_;
  const LocalMotionSettings& settings_;
};

}  // namespace

DisplacementField::DisplacementField(const NeedleFrame& frame, double from_mm, double to_mm, double radius_mm,
                                     double spacing_mm)
    : frame_(frame), spacing_mm_(spacing_mm) {
  const int along = static_cast<int>(std::ceil(std::max(to_mm - from_mm, 1.0) / spacing_mm)) + 1;
  const int half = static_cast<int>(std::ceil(radius_mm / spacing_mm));
  size_ = {along, 2 * half + 1, 2 * half + 1};
  low_ = {0.5 * (from_mm + to_mm - (along - 1) * spacing_mm), -half * spacing_mm, -half * spacing_mm};
  displacements_.assign(static_cast<std::size_t>(size_.prod()), Eigen::Vector3d::Zero());
}

bool DisplacementField::nodes_at(const Point& p_S, Nodes& nodes) const {
  if (displacements_.empty()) return false;
  const Eigen::Vector3d x = (frame_.coordinates(p_S) - low_) / spacing_mm_;
  Eigen::Vector3i cell;
  for (int a = 0; a < 3; ++a) {
    if (!(x[a] >= 0.0 && x[a] <= size_[a] - 1.0)) return false;
    cell[a] = std::min(static_cast<int>(x[a]), size_[a] - 2);
  }
  const Eigen::Vector3d f = x - cell.cast<double>();
  for (int n = 0; n < 8; ++n) {
    const int i = n & 1, j = (n >> 1) & 1, k = n >> 2;
    nodes.node[n] = node(cell.x() + i, cell.y() + j, cell.z() + k);
    nodes.weight[n] = (i ? f.x() : 1.0 - f.x()) * (j ? f.y() : 1.0 - f.y()) * (k ? f.z() : 1.0 - f.z());
  }
  return true;
}

Eigen::Vector3d DisplacementField::at(const Point& p_S) const {
  Nodes nodes;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (!nodes_at(p_S, nodes)) return sum;
  for (int n = 0; n < 8; ++n)
    sum += nodes.weight[n] * displacements_[static_cast<std::size_t>(nodes.node[n])];
  return sum;
}

DisplacementField register_local(const Volume& before, std::span<const Volume> after,
                                 const RigidTransform& X_before_after, const NeedleMask& mask,
                                 const LocalMotionSettings& settings) {
  TissueMotion motion{X_before_after, DisplacementField(mask.frame, settings.from_mm, settings.to_mm,
                                                        settings.radius_mm, settings.spacing_mm)};
  for (const double sigma_mm : {1.5, 0.7}) {
    const Volume smooth = smoothed_coarse(before, sigma_mm);
    const Sampler sampler(smooth);
    std::vector<Compared> stacks;
    for (const Volume& stack : after) {
      stacks.push_back(compared(thinned(smoothed_coarse(stack, sigma_mm), 2.5 * sigma_mm), sampler, motion,
                                mask, sigma_mm));
    }
    const LocalFit fit(sampler, stacks, mask, settings);
    for (int n = 0; n < 3; ++n) fit.improve(motion);
  }
  return motion.local;
}

}  // namespace biopsy::imaging
