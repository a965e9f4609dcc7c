// The finding of a selection: verdict, effects with probabilities, changed parameters, the new model, and
// where the residual was.
#pragma once

#include "sim/gap/find_gap.hpp"

namespace biopsy::sim::gap {

// `before`: the given model, fitted in the parameters that were declared free.
FoundGap make_finding(const PlantModel& given, const ScoredModel& before, const Selection& selection,
                      const Evidence& evidence);

// The model with a proposed term as the last, and what changed in it.
void set_proposed_model(FoundGap& found, const Hypothesis& proposed, const Evidence& evidence);

}  // namespace biopsy::sim::gap
