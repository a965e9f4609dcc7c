#include "planner/imaging/io/labels.hpp"

#include <fmt/format.h>

#include <cmath>
#include <unordered_set>

#include "planner/imaging/io/dicom/dicom_segmentation.hpp"
#include "planner/imaging/io/grid_rules.hpp"
#include "planner/imaging/io/label_pattern.hpp"
#include "planner/imaging/io/nrrd/nrrd_segmentation.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::imaging {
namespace {

// Smallest and largest index of `labels` in which a point of the image can lie; those of the map are among
// them.
std::pair<Eigen::Vector3i, Eigen::Vector3i> reach_of(const Grid& image, const Grid& labels) {
  constexpr double kRounding = 1e-6;
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = labels.size.cast<double>().array() - 1.0;
  const AffineTransform X = labels.X_SI.inverse() * image.X_SI;
  for (int corner = 0; corner < 8; ++corner) {
    Point at;
    for (int axis = 0; axis < 3; ++axis) at[axis] = (corner >> axis & 1) != 0 ? image.size[axis] - 0.5 : -0.5;
    const Point index = X * at;
    low = low.cwiseMin((index.array() + 0.5 + kRounding).floor().matrix());
    high = high.cwiseMax((index.array() - 0.5 - kRounding).ceil().matrix());
  }
  return {low.cwiseMax(-kSizeMax).cast<int>(), high.cwiseMin(2.0 * kSizeMax).cast<int>()};
}

}  // namespace

LabelMap read_labels(const std::filesystem::path& path, bool anyway) {
  if (is_nrrd_segmentation(path)) return read_nrrd_segmentation(path);
  if (const auto file = dicom_segmentation_at(path)) return read_dicom_segmentation(*file);
  LabelMap map{.volume = read_volume(path), .names = {}};
  if (const std::string doubt = refuse_unlike_labels(map.volume, path.string(), anyway); !doubt.empty())
    map.volume.warnings.push_back(doubt);
  return map;
}

void refuse_large_labels(const Grid& grid, const std::string& where) {
  constexpr double kMost = 268'435'456.0;
  if (grid.size.cast<double>().prod() > kMost)
    throw ConfigError(fmt::format("{} x {} x {} voxels are too many for labels", grid.size.x(), grid.size.y(),
                                  grid.size.z()),
                      where, "save the segmentation on the grid of the image");
}

void cover_image(const Grid& image, LabelMap& map) {
  if (!map.ends_unlabelled) return;
  const Grid drawn = map.volume.grid;
  const auto [low, high] = reach_of(image, drawn);
  Grid& grid = map.volume.grid;
  grid.size = high - low + Eigen::Vector3i::Ones();
  if (grid.size == drawn.size) return;
  refuse_bad_size(grid.size, map.volume.files.front());
  refuse_large_labels(grid, map.volume.files.front());
  grid.X_SI.translation() = drawn.X_SI * low.cast<double>();
  std::vector<float> voxels(grid.voxel_count(), 0.0F);
  for (int k = 0; k < drawn.size.z(); ++k)
    for (int j = 0; j < drawn.size.y(); ++j)
      std::copy_n(
          map.volume.voxels.begin() + static_cast<std::ptrdiff_t>(drawn.index(0, j, k)), drawn.size.x(),
          voxels.begin() + static_cast<std::ptrdiff_t>(grid.index(-low.x(), j - low.y(), k - low.z())));
  map.volume.voxels = std::move(voxels);
}

std::string refuse_unlike_labels(const Volume& volume, const std::string& where, bool anyway) {
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
  const LabelPattern pattern = label_pattern(volume);
  const std::string grey = grey_pattern(pattern);
  if (grey.empty()) return {};
  if (anyway) return "it looks like a grey image: " + grey;
  throw ConfigError(
      fmt::format("no label map: {} different values, and {}, as in a grey image", pattern.values, grey),
      where, "give the label map (segmentation) of the image; if it is one, say so with --labels-anyway");
}

}  // namespace biopsy::imaging
