// What a mechanism's data say about how to compare: parameters that are not what the model says, and whether
// whole runs can be simulated at all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/gap/select/select.hpp"
#include "sim/plant/dataset.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::gap {

struct Choice {
  std::vector<std::string> free;  // baseline parameters to fit without a prior
  std::optional<double> window;   // s
  std::string reason;             // a sentence; empty where nothing was chosen
};

// Only for drive = "force": a stage's parameters are measured by its calibration. A mechanism without a
// spring integrates every small error, so it is cut into windows, unless whole runs leave less: where the
// sensor is coarse, the motion with which a window starts is known worse than rest. A parameter is free where
// the data determine it to better than a fifth, or want it far from the model's value; where they want one a
// tenth away, and the misfit falls by half.
Choice choose(const Dataset& dataset, const PlantModel& model);

// Windows for a mechanism that drifts: none where a spring holds it, or for a stage.
std::optional<double> window_of_drift(const Dataset& dataset, const PlantModel& model);

// s; short enough for the mechanism's ringing to stay in phase with the model's, and so long that the motion
// departs from a uniform one by more than noise.
double short_window(const Dataset& dataset, const PlantModel& model);

// The hypothesis with all numbers of its mechanism fitted freely; none for a stage, or where they are free.
std::optional<ScoredModel> with_numbers_free(const ScoredModel& start, const Evidence& evidence);

// "m, c_s and k": those that the hypothesis fits freely.
std::string names_of_numbers(const Hypothesis& hypothesis);

// Of a mechanism, not of a stage: widens the standard deviation of each free number that seems known, where a
// value five times as large or small follows the record as well when all others are fitted again.
void widen_untold(ScoredModel& best, const Evidence& evidence);

// Whether a free number is known to better than a fifth, if there are any.
bool tells_a_number(const Hypothesis& hypothesis);

}  // namespace biopsy::sim::gap
