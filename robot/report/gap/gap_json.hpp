// The finding as gap.json: the interface's keys first and exactly (docs/how-to/find-missing-effects.md), then
// additions. Numbers that are not known are null.
#pragma once

#include <string>

#include "sim/gap/gap_finding.hpp"

namespace biopsy::report {

std::string gap_json(const GapFinding& finding);

}  // namespace biopsy::report
