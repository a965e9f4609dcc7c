// A smooth correction of a rigid motion near the needle: tissue that was deformed between two images (a
// bladder that filled, a rectum that emptied).
#pragma once

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
  bool nodes_at(const Point& p_S, Nodes& nodes) const;
  Eigen::Vector3d at(const Point& p_S) const;  // mm, scanner axes

  const Eigen::Vector3i& size() const { return size_; }
  int node(int i, int j, int k) const { return i + size_.x() * (j + size_.y() * k); }
  std::vector<Eigen::Vector3d>& displacements() { return displacements_; }
  const std::vector<Eigen::Vector3d>& displacements() const { return displacements_; }

 private:
  NeedleFrame frame_;
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();  // (along, across, up) of the first node
  double spacing_mm_ = 1.0;
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
