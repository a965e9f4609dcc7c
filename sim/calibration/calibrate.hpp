// One parameter set for all of the paper's figures: a global search by CMA-ES, last steps by Ceres, and from
// the figures' sensitivity how well each number is known.
#pragma once

#include <functional>
#include <string>

#include "sim/calibration/cma_es.hpp"
#include "sim/calibration/objective.hpp"
#include "sim/model_file.hpp"

namespace biopsy::sim::calibration {

struct CalibrationSettings {
  int evaluations = 600;  // of the global search; work and not time, so that the answer is the same anywhere
  int last_steps = 3;     // of Ceres
  std::uint64_t seed = 1;
  double spread = 0.2;  // of the first draws around the first guesses, in doubts
};

struct KnobFound {
  Knob knob;
  double value = 0.0, std = 0.0;  // file units
  bool at_bound = false;          // the paper asks for more than is plausible
};

struct Calibration {
  paper::PaperModel model;
  std::vector<KnobFound> knobs;
  Eigen::MatrixXd correlations;      // of the knobs, in their order
  std::vector<PaperRow> rows;        // at the answer, as the brief experiments give them
  double before = 0.0, after = 0.0;  // sum of squared residuals where the search began, and at the answer
  int evaluations = 0;
};

// Share done, -1 where that is not known, and what is being done.
using CalibrationProgress = std::function<void(double share, const std::string& doing)>;

// Begins at the knobs' starts, whatever `question.start` has there. Deterministic, on any number of
// cores.
Calibration calibrate(const Question& question, const CalibrationSettings& settings,
                      const CalibrationProgress& progress = {});

}  // namespace biopsy::sim::calibration
