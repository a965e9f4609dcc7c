// biopsy gap --paper: what the paper's figures lack.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robot/cli/command.hpp"

namespace biopsy::robot {

// `model` holds the numbers that are not searched; empty: the calibrated one. `candidates` by their names;
// none: all. Writes paper_gap.json and report.html.
Result gap_paper(std::filesystem::path model, const std::vector<std::string>& candidates,
                 const std::filesystem::path& out, const Context& context);

}  // namespace biopsy::robot
