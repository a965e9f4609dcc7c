// The simulated needle and tissue of a rehearsal.
#pragma once

#include <filesystem>
#include <span>

#include "robot/msg/plan.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::robot {

// The model of the stage with the tissue of these layers along the needle's path. Throws ConfigError.
sim::PlantModel rehearsed_plant(const std::filesystem::path& model, const std::filesystem::path& tissues,
                                std::span<const Layer> layers, double weight_g);

}  // namespace biopsy::robot
