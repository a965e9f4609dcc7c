// Where no effect fits: a force as an equation. Sparse regression of the residual on the answers to forces
// from the dictionary finds a few products; simulation fits their coefficients; runs that neither saw decide
// whether it is proposed.
#pragma once

#include <optional>
#include <stop_token>

#include "sim/gap/gap_finding.hpp"
#include "sim/gap/select/select.hpp"

namespace biopsy::sim::gap {

struct TermProposal {
  ScoredModel scored;  // with the term as the last of the model's, and standard deviations
  ProposedTerm description;
};

// Empty where no equation closes most of the held-out gap, in every held-out run, with coefficients that are
// known to better than half of themselves. `before`: the given model, fitted in what was declared free;
// `start`: with its calibration errors fitted.
std::optional<TermProposal> propose_term(const ScoredModel& before, const ScoredModel& start,
                                         const Evidence& coarse, const Evidence& fine,
                                         const std::stop_token& stop = {});

}  // namespace biopsy::sim::gap
