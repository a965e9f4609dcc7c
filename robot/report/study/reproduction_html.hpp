// The paper's figures as the model draws them, with the paper's numbers beside ours, as one page: score
// first, then each figure with its panels and its table; misses red with the reason, rows beyond the paper
// grey; at the end what was missed, as findings for `biopsy gap`. Loads nothing, runs no script, prints well.
#pragma once

#include <string>

#include "sim/paper/paper_figure.hpp"

namespace biopsy::report {

std::string reproduction_html(const Reproduction& reproduction);

}  // namespace biopsy::report
