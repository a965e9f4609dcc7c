// A stage under the paper's loop (III.C, IV.D): PI on what the laser reads, 1 ms tick, 2 Hz square wave.
#pragma once

#include <functional>
#include <vector>

#include "robot/control/pi_loop.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::paper {

using OfTime = std::function<double(double)>;  // of s since the loop was closed, the stage being at rest

// A weight that is put on plate A and taken off again.
struct LoadStep {
  double from = 0.0, to = 0.0;  // s
  double mass = 0.0;            // kg
};

struct LoopTask {
  OfTime target;  // mm
  double seconds = 10.0;
  std::vector<LoadStep> loads;  // one at a time
};

// The paper's gains on this robot's own range, unless told otherwise.
struct LoopSettings {
  control::PiGains gains;
  double highest = 8000.0;  // V, as far as the paper sweeps its stack (Fig. 8b) and the gate lets it go
  OfTime feed;              // V added to the PI loop's, of time; empty: none, as in the paper
};

// The paper's own loop. It names no limit but its amplifier's: Trek 10/40, 10 V from the DAQ times 1000
// (III.D).
LoopSettings paper_loop();

// One entry a tick. What was read, and what the tick then asked for.
struct Course {
  std::vector<double> time;       // s
  std::vector<double> target;     // mm
  std::vector<double> plate_a;    // mm, as the laser reads it
  std::vector<double> plate_b;    // mm
  std::vector<double> amplitude;  // kV, of the square wave
  double deepest = 0.0;           // mm, true, of plate A
  int layers = 0;                 // of tissue whose surface was punctured
};

// Runs the task. Under a weight plate A moves as if its zero had sunk by m g/k, which is how the added
// inertia gets into a plant that rests where its weight balances; where a spring that is not straight, a stop
// or tissue knows where plate A is, the weight only pushes.
Course follow(const PlantModel& stage, const LoopTask& task, const LoopSettings& settings = {});

// Targets. From low to high at once, low first; and the same without jumps, starting at the bottom. mm, Hz
OfTime square_target(double low, double high, double frequency);
OfTime sine_target(double low, double high, double frequency);
// levels[i] from starts[i] on; 0 before the first.
OfTime stair_target(std::vector<double> starts, std::vector<double> levels);

}  // namespace biopsy::sim::paper
