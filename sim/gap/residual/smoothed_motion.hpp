// Position and speed of a run, smoothed as much as its noise requires.
#pragma once

#include <vector>

#include "sim/gap/select/evidence_runs.hpp"

namespace biopsy::sim::gap {

// Position and speed at every row of a run: least-squares lines through the readings around it.
struct SmoothedMotion {
  std::vector<double> x, v;      // m, m/s
  double half_width = 0.0;       // s, of the readings to either side
  double speed_noise = 0.0;      // m/s, standard deviation of v by the readings' noise
  double usual_top_speed = 0.0;  // m/s, 95th percentile
};

// With the smallest half-width that brings the noise of the speed below 5 % of the usual top speed, at most a
// quarter of a second and a twentieth of the run. `readings`: one per row. m
SmoothedMotion smoothed_motion(const EvidenceRun& run, const std::vector<double>& readings, double noise);

// The same with a given half-width [s], at least two rows to either side.
SmoothedMotion smoothed_motion_within(const EvidenceRun& run, const std::vector<double>& readings,
                                      double noise, double half_width);

// Speed above which plate A moves: above the noise and a share of the usual top speed. m/s
double moving_threshold(const SmoothedMotion& motion);

// Seconds since the voltage last changed sign (stack) or the measured motion last reversed (force); infinite
// before the first time.
std::vector<double> since_reversal(const EvidenceRun& run, const SmoothedMotion& measured, Drive drive);

// s
double duration(const EvidenceRun& run);

}  // namespace biopsy::sim::gap
