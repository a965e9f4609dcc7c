// The verdict of a finding in a sentence or two, for a person.
#pragma once

#include <string>

#include "sim/gap/gap_finding.hpp"

namespace biopsy::report {

std::string verdict_sentence(const GapFinding& finding);

}  // namespace biopsy::report
