// One round: every open candidate against the hypothesis as it stands. Scored, the promising fitted on coarse
// rows, the best fitted well and judged on the held-out runs.
#pragma once

#include "sim/gap/select/select.hpp"

namespace biopsy::sim::gap {

struct Round {
  std::vector<CandidateFit> fits;  // the best first
  double nothing = 0.0;            // log evidence of the hypothesis as it stood
};

struct RoundName {
  int number = 1;
  std::string title;
  double share = 0.0, share_after = 0.0;  // of the work, before and after it
};

// Without fits where `stop` interrupted it.
Round selection_step(const ScoredModel& now, const Evidence& coarse, const Evidence& fine,
                     const RoundName& name, const Progress& progress, const std::stop_token& stop);

// Friction between plate A and its guide, in either of its forms: one contains the other.
bool is_dry_friction(const Candidate& candidate);

// How many stretches of the held-out runs err on their own: the windows, where each starts anew.
double held_out_effective_sample_size(const Evidence& evidence);

}  // namespace biopsy::sim::gap
