// Stages within the model's uncertainty: every uncertain parameter drawn anew.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sim/plant/model_file.hpp"

namespace biopsy::sim::tuning {

struct UncertainStages {
  std::vector<PlantModel> stages;
  std::vector<std::string> varied;  // names as in model files
  bool assumed = false;  // the file has no standard deviations: 10 % for each parameter that shapes the loop
  int refused = 0;       // rejected draws
};

// Whether a draw is consistent with what was measured of the stage.
using IsPlausible = std::function<bool(const PlantModel&)>;

// `count` stages, the same for the same seed. Parameters are normal with the correlations of the file
// (independent where it has none), clamped at two standard deviations and at their ranges. Draws that
// is_plausible rejects are repeated, a hundred times at most. Each stage has its own noise seed.
UncertainStages uncertain_stages(const NotedModel& model, int count, std::uint64_t seed,
                                 const IsPlausible& is_plausible = {});

}  // namespace biopsy::sim::tuning
