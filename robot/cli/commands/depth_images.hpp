// The images that `check` and `calibrate-tip` compare.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "robot/msg/volume.hpp"

namespace biopsy::robot {

struct DepthImageOptions {
  std::filesystem::path before;
  std::vector<std::filesystem::path> after;  // several: planes that were taken together
  std::string before_series;
  std::vector<std::string> after_series;  // of the one folder in `after`

  std::vector<std::filesystem::path> files() const;
};

void add_depth_images(CLI::App& app, DepthImageOptions& options);

struct DepthImages {
  Volume before;
  std::vector<Volume> after;
  // What a person must know of them, once each: the readers' warnings, another frame of reference, a time
  // that runs backwards.
  std::vector<std::string> warnings;
};

// Throws ConfigError as the readers do, and where the images are of two patients.
DepthImages read_depth_images(const DepthImageOptions& options);

// "warning   ..." lines.
std::string warning_lines(const std::vector<std::string>& warnings);

}  // namespace biopsy::robot
