// The table that a command prints after a run: patient and series, target, layers, steps, margins, verdict
// last. Plain UTF-8 text; with `colour` (a terminal) headings are bold and alarms red. Text from files cannot
// move the cursor.
#pragma once

#include <string>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

std::string console_table(const RunRecord& record, bool colour);

}  // namespace biopsy::report
