// Position and speed at given moments of a recording, from the readings around them.
#pragma once

#include "sim/plant/dataset.hpp"

namespace biopsy::sim::gap {

struct StartMotion {
  double x = 0.0, v = 0.0;  // m, m/s
};

// Local cubics through the readings on both sides of `rows`. One width for the whole run: the widest that the
// motion still follows within 1.5 `noise` [m] at three of four moments, at most a quarter of the distance
// between them. A speed below three of its standard deviations is a standstill, so that friction can hold it.
std::vector<StartMotion> window_starts(const RecordedRun& run, const std::vector<std::size_t>& rows,
                                       double noise);

}  // namespace biopsy::sim::gap
