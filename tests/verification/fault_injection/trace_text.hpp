// One run as a timeline that a person can read.
#pragma once

#include <string>

#include "tests/verification/fault_injection/campaign.hpp"

namespace biopsy::fault_injection {

std::string trace_text(const FaultClass& fault, const RunResult& result);

}  // namespace biopsy::fault_injection
