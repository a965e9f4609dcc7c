// What image series lie under a path, for a person to choose from.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace biopsy::imaging {

struct SeriesSummary {
  std::string series_uid;  // SeriesInstanceUID; for the other formats the file's name below the folder
  std::string description, modality, format;
  int slices = 0;
  Eigen::Vector3i size = Eigen::Vector3i::Zero();  // voxels, zero where there is a problem
  Eigen::Vector3d spacing_mm = Eigen::Vector3d::Zero();
  std::vector<std::string> files;
  std::string problem;  // why it cannot be read as a volume; empty = readable by its headers
};

// Looks at a file, or a folder with all below it, by the headers alone. Throws ConfigError only when there is
// no image.
std::vector<SeriesSummary> list_series(const std::filesystem::path& path);

}  // namespace biopsy::imaging
