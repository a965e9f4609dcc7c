// What to measure next, so that explanations which fit the present data equally well come apart.
#pragma once

#include <string>
#include <vector>

#include "sim/gap/gap_finding.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::gap {

// Simulates every rival in every experiment of the menu and takes the one whose two most alike rivals differ
// most, by the RMS of their readings. `names`: one a rival. `noise`: standard deviation of a reading, m.
// `largest_force`: what a force-driven rig can push with, N; a stack does not use it. difference is in mm.
// Where even the best experiment leaves two rivals alike within the noise, the name is empty, nothing is
// separated and the sentence says which two; so with fewer than two rivals. All rivals have the same drive.
//
// Stack: dc_hold, voltage_staircase_up_and_down, frequency_sweep, weight_drop, slow_triangle, and
// closed_loop_steps, which runs the paper's PI loop (eq. (22), 0.8 kV/mm and 0.005 kV/mm a tick) on each
// rival; what such a loop does differently from one go to the next is no difference between rivals. An
// experiment that throws a rival's plate beyond the stroke and its 2 mm of grace is never proposed: the
// lightly damped baseline under that loop is one (paper IV.D has friction). Force: force_steps, force_chirp,
// slow_force_triangle, free_decay.
NextExperiment next_experiment(const std::vector<PlantModel>& rivals, const std::vector<std::string>& names,
                               double noise, double largest_force = 1.0);

}  // namespace biopsy::sim::gap
