// Label maps: which tissue each voxel is.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

struct LabelMap {
  Volume volume;                     // whole numbers from 0
  std::map<int, std::string> names;  // that the file gives
  bool ends_unlabelled = false;      // outside of the volume is 0: it was cut to what is drawn
};

// A segmentation of 3D Slicer (.seg.nrrd) or of DICOM, or any volume that is a label map. `anyway`: a
// person answers that it is one, though it looks like a grey image. Throws ConfigError as its reader does.
LabelMap read_labels(const std::filesystem::path& path, bool anyway = false);

// Throws ConfigError for more than 2^28 voxels, of which most would be empty.
void refuse_large_labels(const Grid& grid, const std::string& where);

// Where the map ends unlabelled, its volume grows over the image, by zeros; else it stays as it is.
void cover_image(const Grid& image, LabelMap& map);

// Throws ConfigError naming `where` for a volume that is no label map: values that are negative or no whole
// numbers, more than kLabelsMax of them, or a pattern of grey (label_pattern.hpp), which is returned as a
// warning where a person answers for it.
inline constexpr std::size_t kLabelsMax = 1000;
std::string refuse_unlike_labels(const Volume& volume, const std::string& where, bool anyway = false);

}  // namespace biopsy::imaging
