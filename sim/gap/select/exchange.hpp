// Two-fold cross-validation, where the held-out runs cannot decide: they may hold nearly nothing of what the
// training runs show.
#pragma once

#include "sim/gap/select/compare_candidates.hpp"

namespace biopsy::sim::gap {

// Whole runs are held out: the last third of one cannot be simulated alone.
bool can_exchange(const Evidence& evidence);

// Trained on the held-out runs, tested on the others.
Evidence exchanged(Evidence evidence);

// The candidates that the held-out runs leave open are fitted with the parts exchanged as well, and the sum
// of both log evidences ranks them. False, with the round as it was, where nothing is to be gained: no model
// of the training runs leaves more than noise there, or the best predicts the held-out runs worse than `now`.
bool judge_by_both(Round& round, const ScoredModel& now, const Evidence& fine);

// Mean square over both parts, each as held out; of the held-out runs alone where they sufficed. m^2
double square_of_both(const CandidateFit& fit, const Evidence& fine);
double square_of_both(const ScoredModel& now, const Round& round, const Evidence& fine);

}  // namespace biopsy::sim::gap
