// biopsy gap --paper: what the paper's figures lack.
#pragma once

#include <filesystem>

#include "robot/cli/command.hpp"

namespace biopsy::robot {

// `model` holds the numbers that are not searched; empty: the calibrated one. Writes paper_gap.json and
// report.html.
Result gap_paper(std::filesystem::path model, const std::filesystem::path& out, const Context& context);

}  // namespace biopsy::robot
