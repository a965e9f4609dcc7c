// Runs thinned for drawing, with the peaks of the residual kept.
#pragma once

#include <vector>

#include "sim/gap/gap_finding.hpp"
#include "sim/gap/residual/localize_residual.hpp"

namespace biopsy::sim::gap {

inline constexpr std::size_t kMostTracePoints = 2000;

// One trace per run of at most kMostTracePoints points: least and largest residual, before and after, of each
// bucket of rows. A run of which a part was held out gives two traces of the same name. Time in s,
// input in kV (Drive::Force: N), measured and the two models' readings in mm; regimes as in main_regime.
std::vector<GapTrace> traces(const Evidence& evidence, const std::vector<double>& before,
                             const std::vector<double>& after, const MainRegimes& regimes, Drive drive);

}  // namespace biopsy::sim::gap
