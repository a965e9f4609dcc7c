// Regimes in which model and measurement disagree: rows of all runs sorted into regimes, each with its share
// of the time and of the squared error above the noise.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/gap/gap_finding.hpp"
#include "sim/gap/select/evidence_runs.hpp"

namespace biopsy::sim::gap {

// `before`, `after`: measured - model of all rows of all runs, concatenated (Part::All). m
// Regimes that concentrate the error come first, by lift = share of error / share of time; then those that
// are too short or too slight to matter; last those with a lift near 1. Shares and errors are weighted by
// time, so that rows joined by `prepare` count with their duration. The result is in mm.
std::vector<GapRegime> localize_residual(const Evidence& evidence, const std::vector<double>& before,
                                         const std::vector<double>& after, Drive drive);

// One regime a row, for shading a trace.
struct MainRegimes {
  std::vector<std::string> names;
  std::vector<std::uint8_t> of_row;  // index in names; rows of all runs, concatenated
};

// After a reversal, else stuck, else by speed; "holding" is everything slow and not stuck.
MainRegimes main_regime(const Evidence& evidence, const std::vector<double>& before, Drive drive);

}  // namespace biopsy::sim::gap
