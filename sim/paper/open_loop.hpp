// Experiments without feedback: a square wave or a constant voltage on the stack, and the laser's readings.
#pragma once

#include <vector>

#include "sim/paper/paper_model.hpp"
#include "sim/plant/plant.hpp"

namespace biopsy::sim::paper {

// A voltage of one amplitude. frequency 0: DC.
struct OpenLoopDrive {
  double amplitude = 0.0;  // V
  double frequency = 0.0;  // Hz of the square wave; half a period is a whole number of `period`s
  double settle = 0.0;     // s before anything is recorded
  double watch = 0.0;      // s that are recorded
  double period = 5e-3;    // s between records
};

struct OpenLoopRun {
  std::vector<double> time;              // s since the voltage was put on
  std::vector<double> displacement;      // mm, plate A as the laser reads it, without its noise
  std::vector<double> plate_b;           // mm
  std::vector<double> voltage, current;  // V and A of the amplifier: held, and mean, since the record before
};

// From rest. With `skip_settling` the leakage starts where it settles under the square wave, eq. (15), and of
// `settle` only so much is waited that the pouches, the plate and the voltage's memory have come to rest.
OpenLoopRun run_open_loop(const PlantModel& model, const OpenLoopDrive& drive, bool skip_settling);

// Square wave of `frequency` from the instant 0, +1 or -1; DC is +1 for ever.
double polarity_at(double time, double frequency);

// The set-up of Fig. 6 and 7: `pouches` of them, and one plate straight on top: its slider of 30 g and a
// weight. The paper's loads of 50, 80 and 130 g are that slider with 20, 50 and 100 g. One slider instead of
// the stage's two (III.B, IV.A): half of the guide's friction and damping.
PlantModel plate_on_stack(PlantModel stage, double pouches, double weight);

// A rigid pole in place of the series spring: a spring so stiff that it gives less than the laser resolves in
// any motion but the first leap.
PlantModel with_rigid_pole(PlantModel stage);

// Largest static friction of the guide, by whichever effect models it. N
double guide_friction(const PlantModel& stage);

// Largest less smallest.
double peak_to_peak(const std::vector<double>& values);

}  // namespace biopsy::sim::paper
