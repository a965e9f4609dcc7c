// Recorded inputs through the plant, open loop.
#pragma once

#include "sim/plant/dataset.hpp"

namespace biopsy::sim {

// The run with displacement, plate B and current replaced by the model's; starts at rest. The current of a
// row is the mean since the row before, as of a monitor that averages.
RecordedRun simulate(PlantModel model, const RecordedRun& recorded);

}  // namespace biopsy::sim
