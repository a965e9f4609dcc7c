// One run as a timeline that a person can read.
#pragma once

#include <string>

#include "tests/verification/fault_injection/campaign.hpp"

namespace biopsy::proof {

std::string story_of(const FaultClass& fault, const RunResult& result);

}  // namespace biopsy::proof
