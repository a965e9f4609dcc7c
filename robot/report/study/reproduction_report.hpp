// The paper's figures as the model draws them, with the paper's numbers beside ours.
#pragma once

#include <filesystem>
#include <string>

#include "sim/paper/paper_figure.hpp"

namespace biopsy::report {

// report.html and reproduce.json. Makes the folder. Throws ConfigError where it cannot write.
void save_reproduction(const Reproduction& reproduction, const std::filesystem::path& folder);

// One page: score first, then each figure with its panels and its table; misses red with the reason, rows
// beyond the paper grey; at the end what was missed, as findings for `biopsy gap`. Loads nothing, runs no
// script.
std::string reproduction_html(const Reproduction& reproduction);

// {"rows": [{"figure", "quantity", "unit", "kind", "paper", "ours", "band", "ok", "leakage_ok", "held_out",
// "held_out_ok", "note"}], "findings": [rows that are missed, for the gap workflow], "score", "fitted",
// "model", "seconds"}. A number that could not be computed is null.
std::string reproduction_json(const Reproduction& reproduction);

// The rows as a table for a terminal, misses with their reason, the score last. Without colour where the
// output is no terminal: plain text of the same width.
std::string reproduction_console(const Reproduction& reproduction, bool colour);

}  // namespace biopsy::report
