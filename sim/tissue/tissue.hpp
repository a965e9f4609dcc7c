// Tissues by name, and the layers of a path made of them.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "robot/msg/plan.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim {

// Laws of one tissue, its surface at depth 0.
using TissueTable = std::map<std::string, TissueLayer>;

// [tissue.NAME] tables with the parameters of layer_puncture, shaft_friction and tissue_relaxation but their
// positions. Throws ConfigError naming file and line.
TissueTable read_tissues(const std::filesystem::path& file);

// The layers of a plan as tissue in the plant. A name that is not in the table becomes `unknown`. Throws
// ConfigError where a path has more layers than the plant holds.
std::vector<TissueLayer> tissue_along(std::span<const Layer> layers, const TissueTable& table);

}  // namespace biopsy::sim
