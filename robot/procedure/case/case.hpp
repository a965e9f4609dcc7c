// One procedure: image, entry and target, tissue layers, robot pose, pace, and what a rehearsal simulates.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "planner/plan/insertion_steps.hpp"
#include "planner/plan/layers.hpp"
#include "robot/msg/plan.hpp"
#include "robot/procedure/case/rehearsal_settings.hpp"

namespace biopsy::robot {

// Where confirmation images come from: with a folder, from a scanner that exports into it.
struct ImageSource {
  std::filesystem::path folder;                 // empty: the simulated scanner
  std::chrono::milliseconds quiet{2000};        // without a change before a series counts as complete
  std::chrono::milliseconds patience{120'000};  // how long an image is waited for
  std::string confirmed_by;  // a person who answers for images that do not name their patient
  std::size_t planes = 0;    // that the scanner exports as a series each; 0: not known
};

struct Case {
  std::string title;
  bool phantom = false;         // the built-in tissue block instead of an image
  std::filesystem::path image;  // file or folder
  std::string series_uid;
  std::filesystem::path labels;  // empty: none
  bool labels_anyway = false;    // a person answers for labels that look like a grey image
  planner::LabelNames label_names;
  std::vector<Layer> layers;                     // a table instead of labels
  std::optional<Point> p_SE, p_ST;               // LPS mm; of a phantom: its own; neither: set at the console
  std::filesystem::path markups;                 // the file that they are from; empty: numbers
  std::optional<Millimetres> depth;              // phantom only: target on the needle's axis
  std::filesystem::path fiducials;               // CSV; empty: none
  std::optional<std::vector<double>> transform;  // 16 numbers, robot to scanner RAS
  Grams weight{50.0};
  planner::Staging staging = planner::Staging::Automatic;
  std::vector<Millimetres> waypoints;
  planner::Pace pace;
  PiGains gains{};
  std::optional<TipOffset> tip_offset;  // without it no confirmation image is accepted
  Rehearsal rehearsal;
  ImageSource images;  // of this run: given on the command line, not by the file
  std::uint64_t seed = 1;
};

// The files it names; empty paths where it names none.
std::vector<std::filesystem::path> files_of(const Case& given);

// Whether entry and target are known; otherwise they are set on the image at the console.
bool has_points(const Case& given);

// Entry and target from the points with these labels, of 3D Slicer's file. Throws ConfigError naming the
// place.
void take_markups(const std::filesystem::path& file, const std::string& entry_label,
                  const std::string& target_label, Case& out);

// `name_or_path`: a case file, or the name of a built-in case. Throws ConfigError naming file and line.
Case read_case(const std::string& name_or_path);

// Defaults of a case that is given by --image, --entry and --target alone.
Case blank_case();

std::vector<std::string> built_in_cases();

}  // namespace biopsy::robot
