// The words people and files use for the enumerations of the messages.
#pragma once

#include <string_view>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

std::string_view word(Outcome outcome);
std::string_view word(Mode mode);
std::string_view word(StopCategory stop);
std::string_view word(GateVerdict verdict);
std::string_view word(StepKind kind);
std::string_view word(DepthVerdict verdict);

}  // namespace biopsy::report
