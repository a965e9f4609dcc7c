// Stages that the model's numbers leave room for: the same model with every uncertain number drawn anew.
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
  bool assumed = false;  // the file knows no standard deviations: 10 % each of what shapes the loop
  int refused = 0;       // draws that could not be the stage
};

// What a draw must do to be the stage that the model describes.
using CanBe = std::function<bool(const PlantModel&)>;

// `count` stages, the same for the same seed. Numbers are drawn as normals with the correlations of the file,
// independent where it has none, cut at two standard deviations and at their sensible range. A draw may still
// be a stage that what was measured rules out: can_be says which, and they are drawn again (a hundred times
// at most).
// Each stage also has a noise of its own.
UncertainStages uncertain_stages(const NotedModel& model, int count, std::uint64_t seed,
                                 const CanBe& can_be = {});

}  // namespace biopsy::sim::tuning
