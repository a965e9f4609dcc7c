// A stage under the paper's loop (III.C, IV.D): PI on the laser's reading, 1 ms tick, 2 Hz square wave.
#pragma once

#include <functional>
#include <vector>

#include "robot/control/pi_loop.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::paper {

using OfTime = std::function<double(double)>;  // of s since the loop was closed at rest

// A weight on plate A during a time.
struct LoadStep {
  double from = 0.0, to = 0.0;  // s
  double mass = 0.0;            // kg
  double speed = 0.0;           // m/s, downward, with which it meets plate A
};

struct LoopTask {
  OfTime target;  // mm
  double seconds = 10.0;
  std::vector<LoadStep> loads;  // one at a time
};

// Defaults: the paper's gains within this robot's voltage range.
struct LoopSettings {
  PiGains gains;
  double highest = 8000.0;  // V, as far as Fig. 8b sweeps the stack, and the gate's limit
  OfTime feed;              // V, feed-forward; empty: none, as in the paper
  double period = 1e-3;     // s between iterations, whole ticks; the gains are per iteration
};

// The paper's loop, limited only by its amplifier: Trek 10/40, 10 V from the DAQ times 1000 (III.D).
LoopSettings paper_loop(double period = 1e-3);

// One entry per tick: the reading, and the amplitude commanded after it.
struct Course {
  std::vector<double> time;       // s
  std::vector<double> target;     // mm
  std::vector<double> plate_a;    // mm, as the laser reads it
  std::vector<double> plate_b;    // mm
  std::vector<double> amplitude;  // kV, of the square wave
  double deepest = 0.0;           // mm, true, of plate A
  int layers = 0;                 // of tissue whose surface was punctured
};

// Runs the task. A weight on plate A adds mass and shifts the plate's zero by m g/k, because the plant's zero
// is its equilibrium under weight. Where a force depends on plate A's position (nonlinear spring, stop,
// tissue) that shift is not possible and the weight acts as a force without inertia, and without impact.
Course follow(const PlantModel& stage, const LoopTask& task, const LoopSettings& settings = {});

// Targets in mm, Hz: a square wave that begins at `low`, and a sine that begins at its minimum.
OfTime square_target(double low, double high, double frequency);
OfTime sine_target(double low, double high, double frequency);
// levels[i] from starts[i] on; 0 before the first.
OfTime stair_target(std::vector<double> starts, std::vector<double> levels);

}  // namespace biopsy::sim::paper
