// The verdict on a selection. Conservative: a wrong name is worse than none.
#pragma once

#include <string>

#include "sim/gap/gap_finding.hpp"
#include "sim/gap/select/select.hpp"

namespace biopsy::sim::gap {

// `before`: the given model, fitted in the parameters that were declared free.
GapVerdict verdict(const ScoredModel& before, const Selection& selection, const Evidence& evidence);

// Why what was selected is not the verdict where no objection was raised to it, as a clause for a sentence.
std::string reason_against(const ScoredModel& before, const Selection& selection, const Evidence& evidence);

// Share of the held-out RMSE above the noise that is gone; all of it where the model before ran away.
double gap_closed(double square_before, double square_after, double noise);

// Whether most of the gap is closed or the remainder is far below the noise.
bool well_explained(double square_before, double square_after, const Evidence& evidence);

// Of the first selected effect: the least held-out mean square of the candidates that predict something else,
// over the winner's. Infinite where there was none.
double margin_over_next(const Selection& selection);
inline constexpr double kClearMargin = 1.4 * 1.4;

}  // namespace biopsy::sim::gap
