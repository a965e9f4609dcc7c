// Model files (docs/model.md, section 3): TOML with [baseline] and one [effect.NAME] per effect that is
// present; every value a number or { value, std, source }. Refuses unknown names, missing values and numbers
// out of range, naming file, line and what is allowed.
#pragma once

#include <filesystem>
#include <string>

#include "sim/plant_model.hpp"

namespace biopsy::sim {

PlantModel read_model(const std::filesystem::path& file);
// The same from text; `name` stands for the file in messages.
PlantModel parse_model(const std::string& text, const std::string& name);

}  // namespace biopsy::sim
