// The finding for a terminal, at most 30 lines of plain UTF-8: verdict, RMSE, failing margins, where, what
// was tried, what to do next. Text from outside cannot move the cursor.
#pragma once

#include <string>

#include "sim/gap/gap_finding.hpp"

namespace biopsy::report {

std::string gap_console(const GapFinding& finding);

}  // namespace biopsy::report
