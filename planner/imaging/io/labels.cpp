#include "planner/imaging/io/labels.hpp"

#include <fmt/format.h>

#include <cmath>
#include <unordered_set>

#include "robot/common/config_error.hpp"

namespace biopsy::imaging {

void refuse_unlike_labels(const Volume& volume, const std::string& where) {
  const auto refuse = [&](const std::string& what) {
    throw ConfigError(what, where, "give the label map (segmentation) of the image, not an image");
  };
  std::unordered_set<float> values;
  float last = 0.0F;
  for (const float value : volume.voxels) {
    if (value == last) continue;  // most are
    last = value;
    if (!(value >= 0.0F && value < 1e6F) || value != std::round(value))
      refuse(
          fmt::format("no label map: a voxel has the value {}, and labels are whole numbers from 0", value));
    values.insert(value);
    if (values.size() > kLabelsMax)
      refuse(fmt::format("no label map: more than {} different values", kLabelsMax));
  }
  std::size_t labelled = 0, same = 0;
  for (int axis = 0; axis < 2; ++axis)  // slices may be thicker than what is labelled
    for (int k = 0; k < volume.grid.size.z(); ++k)
      for (int j = axis == 1; j < volume.grid.size.y(); ++j)
        for (int i = axis == 0; i < volume.grid.size.x(); ++i) {
          const float here = volume.at(i, j, k), before = volume.at(i - (axis == 0), j - (axis == 1), k);
          labelled += here != 0.0F || before != 0.0F;
          same += here != 0.0F && here == before;
        }
  const double share = labelled > 0 ? static_cast<double>(same) / static_cast<double>(labelled) : 1.0;
  if (share < kLeastSameNeighbours)
    refuse(
        fmt::format("no label map: {} different values, and only {:.0f} % of the neighbours are alike, "
                    "as in a grey image",
                    values.size(), 100.0 * share));
}

}  // namespace biopsy::imaging
