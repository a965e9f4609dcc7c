// What a mechanism's data say about how to compare: parameters that are not what the model says, and whether
// whole runs can be simulated at all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/plant/dataset.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::gap {

struct Choice {
  std::vector<std::string> free;  // baseline parameters to fit without a prior
  std::optional<double> window;   // s
  std::string reason;             // a sentence; empty where nothing was chosen
};

// Only for drive = "force": a stage's parameters are measured by its calibration. A mechanism without a
// spring integrates every small error, so it is cut into windows. A parameter is free where the data
// determine it to better than a fifth and want it three calibration errors away from the model's value, and
// the misfit falls by half.
Choice choose(const Dataset& dataset, const PlantModel& model);

// Windows for a mechanism that drifts: none where a spring holds it, or for a stage.
std::optional<double> window_of_drift(const Dataset& dataset, const PlantModel& model);

// s; short enough for the mechanism's ringing to stay in phase with the model's.
double short_window(const Dataset& dataset, const PlantModel& model);

}  // namespace biopsy::sim::gap
