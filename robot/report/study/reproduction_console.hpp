// The rows of a reproduction as a table for a terminal, misses with their reason, the score last.
#pragma once

#include <string>

#include "sim/paper/paper_figure.hpp"

namespace biopsy::report {

// Without colour where the output is no terminal: plain text of the same width.
std::string reproduction_console(const Reproduction& reproduction, bool colour);

}  // namespace biopsy::report
