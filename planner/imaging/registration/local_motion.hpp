// A smooth correction of a rigid motion near the needle: tissue that was deformed between two images (a
// bladder that filled, a rectum that emptied).
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "planner/imaging/registration/register_rigid.hpp"

namespace biopsy::imaging {

// Displacements at the nodes of a lattice along the needle's axes, linear between them, none beyond.
class DisplacementField {
 public:
  DisplacementField() = default;  // none anywhere
  DisplacementField(const NeedleFrame& frame, double from_mm, double to_mm, double radius_mm,
                    double spacing_mm);

  // The eight nodes around a place and their weights; false outside the lattice.
  struct Nodes {
    int node[8];
    double weight[8];
  };
  bool nodes_at(const Point& p_S, Nodes& nodes) const {
    if (displacements_.empty()) return false;
    const Eigen::Vector3d x = (frame_.coordinates(p_S) - low_) * per_mm_;
    const double last_x = size_.x() - 1.0, last_y = size_.y() - 1.0, last_z = size_.z() - 1.0;
    if (!(x.x() >= 0.0 && x.y() >= 0.0 && x.z() >= 0.0 && x.x() <= last_x && x.y() <= last_y &&
          x.z() <= last_z))
      return false;
    const int i = std::min(static_cast<int>(x.x()), size_.x() - 2),
              j = std::min(static_cast<int>(x.y()), size_.y() - 2),
              k = std::min(static_cast<int>(x.z()), size_.z() - 2);
    const double fx = x.x() - i, fy = x.y() - j, fz = x.z() - k;
    const double beside[4] = {(1.0 - fy) * (1.0 - fz), fy * (1.0 - fz), (1.0 - fy) * fz, fy * fz};
    const int node_at[4] = {node(i, j, k), node(i, j + 1, k), node(i, j, k + 1), node(i, j + 1, k + 1)};
    for (int n = 0; n < 4; ++n) {
      nodes.node[2 * n] = node_at[n], nodes.weight[2 * n] = (1.0 - fx) * beside[n];
      nodes.node[2 * n + 1] = node_at[n] + 1, nodes.weight[2 * n + 1] = fx * beside[n];
    }
    return true;
  }
  Eigen::Vector3d at(const Nodes& nodes) const {  // mm, scanner axes
    double x = 0.0, y = 0.0, z = 0.0;
    for (int n = 0; n < 8; ++n) {
      const Eigen::Vector3d& one = displacements_[static_cast<std::size_t>(nodes.node[n])];
      x += nodes.weight[n] * one.x(), y += nodes.weight[n] * one.y(), z += nodes.weight[n] * one.z();
    }
    return {x, y, z};
  }
  Eigen::Vector3d at(const Point& p_S) const {
    Nodes nodes;
    return nodes_at(p_S, nodes) ? at(nodes) : Eigen::Vector3d::Zero();
  }

  const Eigen::Vector3i& size() const { return size_; }
  int node(int i, int j, int k) const { return i + size_.x() * (j + size_.y() * k); }
  std::vector<Eigen::Vector3d>& displacements() { return displacements_; }
  const std::vector<Eigen::Vector3d>& displacements() const { return displacements_; }

 private:
  NeedleFrame frame_;
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();  // (along, across, up) of the first node
  double per_mm_ = 1.0;                            // nodes
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<Eigen::Vector3d> displacements_;
};

// Where tissue at a place of the after image was in the before image.
struct TissueMotion {
  RigidTransform X_before_after = RigidTransform::Identity();
  DisplacementField local;

  Point before(const Point& p_after) const { return X_before_after * p_after + local.at(p_after); }
};

struct LocalMotionSettings {
  double from_mm = -30.0, to_mm = 60.0, radius_mm = 25.0;  // about the needle's path
  double spacing_mm = 15.0;                                // of the nodes
  double strain = 0.05;   // of tissue, one standard deviation: how far neighbouring nodes may part
  double reach_mm = 3.0;  // of a displacement, one standard deviation
};

// Least squares over all voxels near the path but those under the mask, which the field bridges smoothly.
DisplacementField register_local(const Volume& before, std::span<const Volume> after,
                                 const RigidTransform& X_before_after, const NeedleMask& mask,
                                 const LocalMotionSettings& settings);

}  // namespace biopsy::imaging
