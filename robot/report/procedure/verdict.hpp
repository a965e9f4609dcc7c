// The result of a run in one sentence, the same in HTML, JSON and on the console; and what is derived from
// it.
#pragma once

#include <string>
#include <vector>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

// "Completed: needle tip at 3.51 mm in liver; image says 3.49 ± 0.06 mm; target 3.50 mm."
// "Refused: ... What to do: ..." and "Stopped: ... What to do: ..." carry the refusal and its remedy.
std::string verdict_sentence(const RunRecord& record);

// The depth check of the last step that has one; nullptr where none was made.
const DepthCheck* last_check(const RunRecord& record);

// The steps that were driven; where none was, the planned ones without results.
std::vector<StepResult> driven_or_planned_steps(const RunRecord& record);

// Share of the limit that was used, in percent; unknown where the limit is not positive.
double used_percent(const LimitUse& use);

}  // namespace biopsy::report
