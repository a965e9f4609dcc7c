// From a selection to what is said: verdict, names with probabilities, numbers that changed, the new model,
// and where the gap was.
#pragma once

#include "sim/gap/find_gap.hpp"

namespace biopsy::sim::gap {

// `before`: the model as given, with only the numbers fitted that were said to be unknown.
FoundGap make_finding(const PlantModel& given, const ScoredModel& before, const Selection& selection,
                      const Evidence& evidence);

}  // namespace biopsy::sim::gap
