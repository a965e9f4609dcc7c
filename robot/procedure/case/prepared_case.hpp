// From a case to everything a run needs: image, registration, layers, plan.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "robot/msg/plan.hpp"
#include "robot/msg/volume.hpp"
#include "robot/procedure/case/case.hpp"

namespace biopsy::robot {

struct PreparedCase {
  Case given;
  Volume image;
  Target target;  // zeros until a person has picked the points
  std::vector<Layer> layers;
  std::variant<Plan, PlanRefusal> plan;
  std::optional<Volume> labels;  // of the tissues, on the same patient
  planner::LabelNames label_names;
  std::vector<std::string> plan_warnings = {};  // what a person must know of points and path
};

// Reads the image, without a plan yet; `target` holds the points that the case names. A phantom is first
// written to `folder`/planning as DICOM, so that it goes the way of any image. Throws ConfigError for bad
// input.
PreparedCase open_case(const Case& given, const std::filesystem::path& folder);

// Layers and plan to `target`. A plan that is refused for medical reasons is a value.
void plan_to_target(PreparedCase& opened);

// Both; of a case without points the image, and tissue without a name.
PreparedCase prepare(const Case& given, const std::filesystem::path& folder);

}  // namespace biopsy::robot
