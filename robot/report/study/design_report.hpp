// A design study as a page, as design.json, and as lines for a terminal: the Pareto-optimal designs, the
// paper's own beside them, every requirement with its reason, and the assumptions.
#pragma once

#include <filesystem>
#include <string>

#include "sim/paper/design/stack_design.hpp"

namespace biopsy::report {

std::string design_html(const DesignStudy& study);
std::string design_json(const DesignStudy& study);
std::string design_console(const DesignStudy& study);

// report.html and design.json. Throws ConfigError where it cannot write.
void save_design(const DesignStudy& study, const std::filesystem::path& folder);

}  // namespace biopsy::report
