// How bright the tissue of one image is in another: coils, sequences and repetition times differ.
#pragma once

#include <vector>

#include "planner/imaging/registration/needle_mask.hpp"

namespace biopsy::imaging {

// after = offset + slope . before, both varying slowly over the image.
struct BrightnessMap {
  Volume slope, offset;                            // on a grid of cells that covers the after image's
  Eigen::Vector3i side = Eigen::Vector3i::Ones();  // of a cell, in voxels of the after image
};

// The map along a row of the after image's voxels, linear between the cells.
class BrightnessRow {
 public:
  BrightnessRow(const BrightnessMap& map, const Grid& after);  // keeps a reference

  void go_to(int j, int k);
  float slope(int i) const { return between(slope_, i); }
  float offset(int i) const { return between(offset_, i); }

 private:
  struct Place {  // between a cell and the next
    std::size_t low, high;
    float f;
  };
  static std::vector<Place> places(int voxels, int side);
  float between(const std::vector<float>& cells, int i) const {
    const Place& at = i_[static_cast<std::size_t>(i)];
    return cells[at.low] + at.f * (cells[at.high] - cells[at.low]);
  }

  const BrightnessMap& map_;
  std::vector<Place> i_, j_, k_;
  std::vector<float> slope_, offset_;  // by cell of the row
};

// Learned from tissue of the rows outside the needle's mask: a void must not count as a change of brightness.
// `before`: of each voxel of the rows, NaN where it is unknown.
BrightnessMap learn_brightness(const Volume& after, const std::vector<VoxelRow>& rows,
                               const std::vector<float>& before, const NeedleMask& needle);

}  // namespace biopsy::imaging
