// The pictures of a gap report as SVG; empty where the finding has nothing to draw.
#pragma once

#include <string>

#include "sim/gap/gap_finding.hpp"

namespace biopsy::report {

// The run in which the old model is furthest from the measurement; null without traces.
const GapTrace* largest_gap_trace(const GapFinding& finding);
// The same among the held-out runs; among all where none is held out.
const GapTrace* overlay_trace(const GapFinding& finding);

// Whether there is a new model to draw, or only the old one.
bool model_changed(const GapTrace& trace);

// Input and residual of the old model against time, regimes shaded, the most telling one in the strongest
// tint.
std::string where_figure(const GapFinding& finding);
// The same for the tenth of the run that disagrees most; empty where the whole run is easy to read.
std::string where_closer_figure(const GapFinding& finding);
// Share of time beside share of excess error, most telling regimes first.
std::string shares_figure(const GapFinding& finding);
// Measured, old and new model of one run; below it the residual of both.
std::string overlay_figure(const GapFinding& finding);
// Mean residual against one quantity.
std::string shape_figure(const ResidualShape& shape);

}  // namespace biopsy::report
