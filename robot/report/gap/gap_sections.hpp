// The sections of a gap report, each a finished piece of HTML; empty where the finding has nothing for it.
#pragma once

#include <string>

#include "sim/gap/gap_finding.hpp"

namespace biopsy::report {

// gap_evidence.cpp: why one should believe it
std::string gap_where_section(const GapFinding& finding);
std::string gap_overlay_section(const GapFinding& finding);
std::string gap_closer_section(const GapFinding& finding);
std::string gap_shapes_section(const GapFinding& finding);
std::string gap_candidates_section(const GapFinding& finding);
std::string gap_regimes_section(const GapFinding& finding);
std::string gap_doubts_section(const GapFinding& finding);

// gap_change.cpp: what the model is now and what follows from it
std::string gap_effects_section(const GapFinding& finding);
std::string gap_proposed_section(const GapFinding& finding);  // gap_proposed.cpp
std::string gap_parameters_section(const GapFinding& finding);
std::string gap_diff_section(const GapFinding& finding);
std::string gap_margins_section(const GapFinding& finding);
std::string gap_fits_section(const GapFinding& finding);
std::string gap_method_section(const GapFinding& finding);

// One sentence a failing margin, for the first page; empty where all hold.
std::string margin_finding(const MarginChange& margin);

}  // namespace biopsy::report
