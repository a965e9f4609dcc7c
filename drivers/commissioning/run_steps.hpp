// Leads an operator through the steps of commissioning and records what was measured.
#pragma once

#include <string>

#include "drivers/commissioning/record.hpp"
#include "drivers/commissioning/rig.hpp"
#include "drivers/commissioning/steps.hpp"

namespace biopsy::commissioning {

// Ends at the first step that does not pass: the next ones rely on it. `record`: everything but the steps.
Record run_steps(Record record, Rig& rig, Operator& operator_);

// All steps with instructions and limits, for the operator to read beforehand.
std::string describe_steps();

// Each figure beside its limits, then "passed" or "FAILED".
std::string to_text(const StepRecord& step);

}  // namespace biopsy::commissioning
