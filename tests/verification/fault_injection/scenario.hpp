// One procedure that could be: a target, tissue on the way, a stage as one of many is built, and a sealed
// plan.
#pragma once

#include <filesystem>

#include "planner/plan/nominal_stage.hpp"
#include "robot/msg/plan.hpp"
#include "robot/procedure/operator.hpp"
#include "safety/types/plan_facts.hpp"
#include "sim/plant/plant_model.hpp"
#include "sim/tissue/tissue.hpp"
#include "tests/verification/fault_injection/draw.hpp"

namespace biopsy::fault_injection {

// The nominal stage and tissues, read once.
struct NominalModels {
  sim::PlantModel stage;
  bool varies = true;  // stages of its kind, without a brake; false: this one as it is
  planner::NominalStage nominal;
  sim::TissueTable tissues;
};
NominalModels read_nominal_models(const std::filesystem::path& models);

struct Scenario {
  Plan plan;
  safety::PlanFacts facts;
  sim::PlantModel plant;
  std::uint64_t noise_seed = 1;
  Seconds scan = robot::kFastScan;  // that an image takes
};

Scenario draw_scenario(const NominalModels& models, std::uint64_t seed);

}  // namespace biopsy::fault_injection
