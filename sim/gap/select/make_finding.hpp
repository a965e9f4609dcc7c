// From a selection to what is said: verdict, names with probabilities, numbers that changed, the new model,
// and where the gap was.
#pragma once

#include "sim/gap/find_gap.hpp"

namespace biopsy::sim::gap {

// `before`: the model as given, with only the numbers fitted that were said to be unknown.
FoundGap conclude(const PlantModel& given, const Judged& before, const Selection& selection,
                  const Evidence& evidence);

}  // namespace biopsy::sim::gap
