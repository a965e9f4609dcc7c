// In which situations do model and measurement disagree? Rows of all runs, sorted into regimes; each with its
// share of the time and of the squared error above the noise.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/gap/gap_finding.hpp"
#include "sim/gap/select/evidence_runs.hpp"

namespace biopsy::sim::gap {

// Position and speed at every row of a run: straight lines through the readings around it.
struct SmoothedMotion {
  std::vector<double> x, v;      // m, m/s
  double half_width = 0.0;       // s, of the readings taken to either side
  double speed_noise = 0.0;      // m/s, standard deviation of v that is the readings' noise
  double usual_top_speed = 0.0;  // m/s, 95 % of the time is slower
};

// As few readings as make the speed meaningful: its noise below 5 % of the usual top speed where at most a
// quarter of a second, and a twentieth of the run, can give that. `readings`: one a row. m
SmoothedMotion smoothed_motion(const EvidenceRun& run, const std::vector<double>& readings, double noise);

// The same with a given half-width [s], at least two rows to either side.
SmoothedMotion smoothed_motion_within(const EvidenceRun& run, const std::vector<double>& readings,
                                      double noise, double half_width);

// Seconds since the voltage last changed sign (stack), or since the measured motion last turned around
// (force); infinite before the first time.
std::vector<double> since_reversal(const EvidenceRun& run, const SmoothedMotion& measured, Drive drive);

// `before`, `after`: measured - model of all rows of all runs, one after the other (Part::All). m
// Regimes that concentrate the error come first, by lift = share of error / share of time; then those too
// short or too slight to matter; last those that err like everything else. Shares and errors are weighted
// by time, so that rows joined by `prepare` count for all they stand for. The result is in mm.
std::vector<GapRegime> localize_residual(const Evidence& evidence, const std::vector<double>& before,
                                         const std::vector<double>& after, Drive drive);

// One regime a row, for shading a trace.
struct MainRegimes {
  std::vector<std::string> names;
  std::vector<std::uint8_t> of_row;  // index in names, rows of all runs one after the other
};

// After a reversal, else stuck, else by speed; "holding" here is whatever is slow and not stuck.
MainRegimes main_regime(const Evidence& evidence, const std::vector<double>& before, Drive drive);

}  // namespace biopsy::sim::gap
