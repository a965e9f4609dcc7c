// Stages as the calibration leaves them open: what is not known of the paper's stage.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "sim/plant/plant_model.hpp"

namespace biopsy::fault_injection {

// `count` stages from the posterior of the model file, the same for the same seed. A draw that contradicts
// what the calibration itself required is drawn anew. Throws ConfigError for an unusable file.
std::vector<sim::PlantModel> drawn_stages(const std::filesystem::path& model, int count, std::uint64_t seed);

}  // namespace biopsy::fault_injection
