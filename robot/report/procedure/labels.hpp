// The names that people and files use for the enumerations of the messages.
#pragma once

#include <string_view>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

std::string_view label(Outcome outcome);
std::string_view label(Mode mode);
std::string_view label(StopCategory stop);
std::string_view label(GateVerdict verdict);
std::string_view label(StepKind kind);
std::string_view label(DepthVerdict verdict);

}  // namespace biopsy::report
