// Reads safety/case: hazards.toml, requirements.toml, evidence.toml, and the risk management file. Format:
// docs/reference/safety-case.md.
#pragma once

#include <filesystem>

#include "robot/report/safety_case/safety_case.hpp"

namespace biopsy::robot {

// Throws ConfigError with file and line.
safety_case::SafetyCase read_safety_case(const std::filesystem::path& folder);

}  // namespace biopsy::robot
