// Reading of a file of faults: [[fault]] tables, format in docs/reference/faults.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/faults/fault.hpp"

namespace biopsy::sim {

// Both throw ConfigError naming file and line: an unknown name, a kind that the signal cannot have, a number
// out of its range, a file without a fault.
std::vector<Fault> parse_faults(const std::string& text, const std::string& file_name);
std::vector<Fault> read_faults(const std::filesystem::path& file);

}  // namespace biopsy::sim
