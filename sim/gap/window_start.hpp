// Position and speed at one moment of a recording, from the readings around it.
#pragma once

#include "sim/dataset.hpp"

namespace biopsy::sim::gap {

struct Motion2 {
  double x = 0.0, v = 0.0;  // m, m/s
};

// Local cubic through the readings on both sides of `row`; `noise` [m] decides how many it takes.
Motion2 window_start(const RecordedRun& run, std::size_t row, double noise);

}  // namespace biopsy::sim::gap
