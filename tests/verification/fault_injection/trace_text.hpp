// One run as a timeline in text.
#pragma once

#include <string>

#include "tests/verification/fault_injection/campaign.hpp"

namespace biopsy::fault_injection {

std::string trace_text(const FaultClass& fault, const RunResult& result);

}  // namespace biopsy::fault_injection
