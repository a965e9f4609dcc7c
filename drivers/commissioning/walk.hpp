// Walks an operator through the steps and keeps what was measured.
#pragma once

#include <string>

#include "drivers/commissioning/record.hpp"
#include "drivers/commissioning/rig.hpp"
#include "drivers/commissioning/steps.hpp"

namespace biopsy::commissioning {

// Ends at the first step that does not pass: what follows relies on it. `record` comes with everything but
// the steps.
Record run_steps(Record record, Rig& rig, Operator& operator_);

// The steps as an operator reads them before the first one.
std::string description();

// "passed", or what did not.
std::string notify(const StepRecord& step);

}  // namespace biopsy::commissioning
