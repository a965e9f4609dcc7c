// What `biopsy reproduce` leaves behind, in one folder: report.html and reproduce.json. Makes the folder.
// Throws ConfigError where it cannot write.
#pragma once

#include <filesystem>

#include "sim/paper/paper_figure.hpp"

namespace biopsy::report {

void save_reproduction(const Reproduction& reproduction, const std::filesystem::path& folder);

}  // namespace biopsy::report
