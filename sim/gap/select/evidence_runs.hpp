// The measured runs prepared for many simulations: rows are joined where the input hardly changes, so that
// the step follows the plant's rates and not the recorder's. Part of them is for training, the rest is held
// out.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/plant/dataset.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::gap {

// Measured at `time`, then the inputs are held for `span`. SI
struct Row {
  double time = 0.0, span = 0.0, input = 0.0, external_force = 0.0, measured = 0.0;
};

// Start of a window, and the measured motion there.
struct WindowStart {
  std::size_t row = 0;
  double x = 0.0, v = 0.0;
};

struct EvidenceRun {
  std::string name;
  double weight = 0.0;  // kg
  std::vector<Row> rows;
  std::size_t training_rows = 0;     // the first so many train, the rest is held out
  std::vector<WindowStart> windows;  // empty: one simulation from rest
};

// What simulating has cost so far, in integrator steps of a mechanism; shared by the copies of an Evidence.
// Counted, not timed: the same data end a search at the same place on any machine.
struct Work {
  std::atomic<std::uint64_t> steps{0};
};

struct Evidence {
  std::vector<EvidenceRun> runs;
  std::shared_ptr<Work> work = std::make_shared<Work>();
  double noise = 0.0;  // m, standard deviation of one reading
  bool noise_given = false;
  double noise_std = 0.0;    // m, of an estimated noise
  double independent = 1.0;  // share of the readings whose error is their own: on one step of a coarse sensor
                             // it repeats
  bool tissue = true;  // the needle may meet tissue: not where a force drives, unless the data set says so
  double training_seconds = 0.0, held_out_seconds = 0.0;
  double x_low = 0.0, x_high = 0.0;  // m, range of what was measured
  double u_max = 0.0;                // largest |input|
  double step_share = 0.1;           // longest step, times the fastest rate of the given model,
  double stiff_step_share = 0.1;     // and of a faster one
  double shortest_step = 1e-4;       // s, however stiff an effect makes the model
  double period = 0.0;               // s, the longest between two readings
  double searched = 1.0;             // share of each run, from its beginning, that the rows cover
  bool roles_given = false;          // the data set says which runs are held out
};

// Which rows are held out: every third run, beginning with the first, second or third; or the last third of
// each run.
enum class HeldOut : std::uint8_t { FromFirst, FromSecond, FromThird, LastThirds };

// Throws ConfigError for a window, s, that is longer than a run or holds less than two of its rows.
void check_window(const Dataset& dataset, double window);

// Every third run is held out, the second first, if the data set does not say which; of a single run its last
// third. `window` [s] splits the runs into windows that start from the measured motion. Throws ConfigError
// where a run is too short. Coarse rows are for searching, fine ones for the final fits and comparisons. Of
// recordings that would take too long to simulate again and again, only the beginning of each run is kept, of
// coarse rows less than of fine ones; the noise is that of all readings.
enum class Sampling : std::uint8_t { Coarse, Fine };
Evidence prepare(const Dataset& dataset, const PlantModel& model, std::optional<double> window,
                 Sampling sampling);

// Not where the data set says what is held out. A single run always gives its last third.
void hold_out(Evidence& evidence, HeldOut which);

// Standard deviation of one reading: given or estimated, at least that of its quantisation. m
double noise_of(const Dataset& dataset);

// Standard deviation of the readings' white part, from their own high-frequency scatter. m
double estimated_noise(const std::vector<RecordedRun>& runs);

}  // namespace biopsy::sim::gap
