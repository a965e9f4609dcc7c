// reproduce.json: {"rows": [{"figure", "quantity", "unit", "kind", "paper", "ours", "band", "ok", "note"}],
// "findings": [rows that are missed, for the gap workflow], "model", "seconds"}. A number that could not be
// computed is null.
#pragma once

#include <string>

#include "sim/paper/paper_figure.hpp"

namespace biopsy::report {

std::string reproduction_json(const Reproduction& reproduction);

}  // namespace biopsy::report
