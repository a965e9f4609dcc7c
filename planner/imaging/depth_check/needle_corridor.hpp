// What changed around the needle's path: the after image beside what the registered before image says should
// be there.
#pragma once

#include <span>
#include <vector>

#include "planner/imaging/registration/register_rigid.hpp"

namespace biopsy::imaging {

// One voxel of the after image. Place of its centre along (t) and beside (u, v) the expected axis, mm.
struct CorridorVoxel {
  float t, u, v;
  float measured;             // after
  float predicted;            // before, moved and matched in brightness
  float variance;             // of measured - predicted where nothing changed
  std::uint32_t stack, cell;  // which stack of slices it belongs to, and its index there
};

constexpr int kPlacesMost = 125;  // of a voxel

// Slices of one orientation: a volume, a slab, a single slice.
struct Stack {
  Eigen::Vector3i size = Eigen::Vector3i::Zero();
  Eigen::Matrix3d steps = Eigen::Matrix3d::Identity();  // columns: from voxel to voxel in needle coordinates
  std::vector<std::uint32_t> rows;       // of `voxels`, where row j + size.y k begins; one more for the end
  Eigen::ArrayX3f places;                // (t, u, v) from a voxel's centre; their mean stands for the voxel's
  std::vector<Eigen::Vector2d> lateral;  // the same for (u, v) alone
  double reach_mm = 0.0;                 // of the farthest place
};

struct Corridor {
  NeedleFrame frame;
  double t_min = 0.0, t_max = 0.0;  // both images cover the axis between these
  double radius_mm = 0.0;
  std::vector<CorridorVoxel> voxels;
  std::vector<std::uint32_t> thinned;  // enough of `voxels` for a search: every second of those of 0.3 mm
  std::vector<Stack> stacks;
  double along_mm = 0.0;  // how far a voxel reaches along the needle, in the sharpest stack
};

struct CorridorSettings {
  double from_mm = -15.0, to_mm = 120.0;  // along the axis from the entry
  double radius_mm = 25.0;
  double needle_mm =
      8.0;  // changes within this of the axis may be the needle: not used to learn what noise is
};

// Empty `voxels` where the images do not overlap on the path.
Corridor needle_corridor(const Volume& before, std::span<const Volume> after,
                         const RegistrationResult& motion, const NeedleFrame& frame,
                         const CorridorSettings& settings);
inline Corridor needle_corridor(const Volume& before, const Volume& after, const RegistrationResult& motion,
                                const NeedleFrame& frame, const CorridorSettings& settings) {
  return needle_corridor(before, std::span(&after, 1), motion, frame, settings);
}

}  // namespace biopsy::imaging
