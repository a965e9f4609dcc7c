// Which case, image, points and model a procedure is given.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace biopsy::robot {

struct ProcedureOptions {
  std::string case_name;  // empty: the built-in liver case, unless an image is given
  std::filesystem::path image, labels, fiducials;
  std::string series, entry, target;  // points: "R,A,S" in mm, or with markups the label of one of its points
  std::filesystem::path markups;      // of 3D Slicer
  std::optional<std::uint64_t> seed;
  std::filesystem::path model, controller;
  std::filesystem::path out;
  bool labels_anyway = false;         // though they look like a grey image
  std::filesystem::path images_from;  // a folder into which a scanner exports; empty: simulated images
  double images_quiet_s = 2.0, images_patience_s = 120.0;
  std::string images_confirmed_by;
  std::size_t images_planes = 0;  // of one confirmation image, as a series each; 0: not known
  std::optional<double> scan_s;   // of a simulated image; empty: as the case says, and fast in real time
  bool real_time = false;
};

}  // namespace biopsy::robot
