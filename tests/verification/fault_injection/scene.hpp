// One procedure that could be: a target, tissue on the way, a stage as one of many is built, and a sealed
// plan.
#pragma once

#include <filesystem>

#include "robot/msg/plan.hpp"
#include "safety/types/plan_facts.hpp"
#include "sim/plant/plant_model.hpp"
#include "sim/tissue/tissue.hpp"
#include "tests/verification/fault_injection/draw.hpp"

namespace biopsy::proof {

// The nominal stage and tissues, read once.
struct Workshop {
  sim::PlantModel stage;
  sim::TissueTable tissues;
};
Workshop open_workshop(const std::filesystem::path& models);

struct Scene {
  Plan plan;
  safety::PlanFacts facts;
  sim::PlantModel plant;
  std::uint64_t noise_seed = 1;
};

Scene draw_scene(const Workshop& workshop, std::uint64_t seed);

}  // namespace biopsy::proof
