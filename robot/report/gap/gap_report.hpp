// What a comparison of model and data leaves behind, in one folder: model.toml (the new model), report.html
// and gap.json. Makes the folder. Throws ConfigError where it cannot write.
#pragma once

#include <filesystem>

#include "sim/gap/gap_finding.hpp"

namespace biopsy::report {

void save_gap(const GapFinding& finding, const std::filesystem::path& folder);

}  // namespace biopsy::report
