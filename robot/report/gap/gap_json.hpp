// The finding as gap.json: the interface's keys first and exactly (docs/gap.md), then additions. Numbers that
// are not known are null.
#pragma once

#include <string>

#include "sim/gap/gap_finding.hpp"

namespace biopsy::report {

std::string gap_json(const GapFinding& finding);

}  // namespace biopsy::report
