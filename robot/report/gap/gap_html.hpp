// The finding as one self-contained page for a person who must believe it: verdict, where, before and after
// on the first sheet, then the evidence. No script, nothing from a network; prints on A4.
#pragma once

#include <string>

#include "sim/gap/gap_finding.hpp"

namespace biopsy::report {

std::string gap_html(const GapFinding& finding);

}  // namespace biopsy::report
