// The next experiment: the one that best separates explanations which fit the present data equally well.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "sim/gap/gap_finding.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::gap {

// What was recorded; an experiment stays within it.
struct RecordedRange {
  double x_low = -std::numeric_limits<double>::infinity();  // m
  double x_high = std::numeric_limits<double>::infinity();
  double input = std::numeric_limits<double>::infinity();  // largest |input|, V or N
};

// Simulates every candidate model in every experiment of the menu and takes the experiment with the largest
// least difference between two of them, by the RMS of their readings. `names`: one per candidate. `noise`:
// standard deviation of a reading, m. `largest_force`: of a force-driven rig, N. difference is in mm. Where
// no experiment separates the candidates by more than the noise, or with fewer than two of them, the name is
// empty and the sentence gives the reason. All candidates have the same drive.
//
// Stack: dc_hold, voltage_staircase_up_and_down, frequency_sweep, weight_drop, slow_triangle, and
// closed_loop_steps with the paper's PI loop (eq. (22), 0.8 kV/mm and 0.005 kV/mm a tick); what such a loop
// does differently from one repetition to the next is not counted as a difference. Experiments that move a
// candidate's plate beyond the stroke and its 2 mm of tolerance are not proposed: the lightly damped baseline
// under that loop is one (paper IV.D has friction). Nor are those that leave the recorded range of positions
// and inputs: amplitudes are those of the recording or less. Force: force_steps, force_chirp,
// slow_force_triangle, free_decay.
NextExperiment next_experiment(const std::vector<PlantModel>& candidates,
                               const std::vector<std::string>& names, double noise,
                               double largest_force = 1.0, const RecordedRange& recorded = {});

}  // namespace biopsy::sim::gap
