// Standard deviation of one reading, from the readings themselves.
#pragma once

#include <vector>

#include "sim/plant/dataset.hpp"

namespace biopsy::sim::gap {

struct NoiseEstimate {
  double value = 0.0;  // m
  double std = 0.0;    // m, of the value, from its scatter over the runs
};

// White part of the readings. Of each run the least of two estimates: differences of second to sixth order,
// to which motion only adds; and, where that is far less, the scatter about the linear difference equation
// that fits readings and input best (total least squares: the smallest singular value of lagged readings from
// which lagged inputs are projected), which fast motion obeys and noise does not. At least the resolution's.
NoiseEstimate estimate_noise(const std::vector<RecordedRun>& runs);

}  // namespace biopsy::sim::gap
