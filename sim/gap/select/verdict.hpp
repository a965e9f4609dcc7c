// From a selection to one word, as little as the data bear: a wrong name is worse than none.
#pragma once

#include "sim/gap/gap_finding.hpp"
#include "sim/gap/select/select.hpp"

namespace biopsy::sim::gap {

// `before`: the model as given, with only the numbers fitted that were said to be unknown.
GapVerdict verdict(const ScoredModel& before, const Selection& selection, const Evidence& evidence);

// Share of the held-out RMSE above the noise that is gone.
double gap_closed(double square_before, double square_after, double noise);

// Whether that leaves nothing to ask for: most of the gap is gone, or what is left is far below the noise.
bool well_explained(double square_before, double square_after, const Evidence& evidence);

// The first effect's contest: the least mean square of any candidate that predicts something else, over the
// winner's. Infinite where there was none.
double lead(const Selection& selection);

}  // namespace biopsy::sim::gap
