// The tissue block of the paper's needle experiment as an image volume: muscle 2 mm, gap 0.9 mm, liver
// behind.
#pragma once

#include <array>
#include <string>

#include "robot/common/units.hpp"
#include "robot/msg/volume.hpp"

namespace biopsy::sim {

struct PhantomSettings {
  Millimetres voxel{0.25};
  Eigen::Vector3d size_mm{40.0, 40.0, 24.0};
  Millimetres muscle{2.0}, gap{0.9};  // paper IV.D
  Millimetres pad{6.0};               // gel pad on the skin side, so that the shaft is seen behind the entry
  std::uint64_t seed = 1;             // of the texture
};

// Lies oblique in the scanner (35 degrees) and the needle oblique in the block (15 degrees), so that a
// mixed-up frame cannot go unseen. The gap is full of saline and bright: in an air gap no image could show a
// needle.
struct Phantom {
  Volume image;
  Volume labels;  // 0 pad and air, 1 muscle, 2 gap, 3 liver
  Point p_SE = Point::Zero();
  Direction axis_S = Direction::UnitZ();
  std::array<std::string, 4> names{"outside", "muscle", "gap", "liver"};
};

// Deterministic. Throws ConfigError when a size or the voxel is not positive or the block has more than 2e8
// voxels.
Phantom paper_phantom(const PhantomSettings& settings = {});

}  // namespace biopsy::sim
