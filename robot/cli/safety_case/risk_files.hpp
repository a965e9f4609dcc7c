// Reads the risk management file of safety/case: risk.toml, software.toml, threats.toml, scenarios.toml.
// Format: docs/reference/safety-case.md.
#pragma once

#include <filesystem>

#include "robot/report/safety_case/risk.hpp"

namespace biopsy::robot {

// Throws ConfigError with file and line.
safety_case::RiskFile read_risk_file(const std::filesystem::path& folder);

}  // namespace biopsy::robot
