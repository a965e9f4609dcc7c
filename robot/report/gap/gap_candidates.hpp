// The order in which people read what was tried: by round; in it the chosen one, then the fitted ones by
// probability and held-out RMSE, then the others by score.
#pragma once

#include <vector>

#include "sim/gap/gap_finding.hpp"

namespace biopsy::report {

std::vector<GapCandidate> ranked_candidates(std::vector<GapCandidate> candidates);

}  // namespace biopsy::report
