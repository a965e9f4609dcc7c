// One parameter set for all of the paper's figures: a global search by CMA-ES, last steps by Ceres, and from
// the figures' sensitivity how well each number is known.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "sim/paper/calibration/cma_es.hpp"
#include "sim/paper/calibration/objective.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::sim::calibration {

// Work and not time, so that the answer is the same anywhere. Spreads are of the first draws around where a
// search begins, in doubts.
struct CalibrationSettings {
  int far = 0;            // evaluations of a search from far away, all rows pulling evenly; 0: none
  int evaluations = 600;  // of the search that counts rows
  int last_steps = 3;     // of Ceres
  std::uint64_t seed = 1;
  int population = 16;
  double far_spread = 0.6, spread = 0.2;
  std::stop_token stop = {};  // ends the search with the best until then; standard deviations stay unknown
};

struct CalibratedParameter {
  Parameter parameter;
  double value = 0.0, std = 0.0;  // file units; std is NaN where the search was interrupted
  bool at_bound = false;          // the paper asks for more than is plausible
  bool only_prior = false;        // nine tenths of the std and more are what was known beforehand
};

struct Calibration {
  paper::PaperModel model;
  std::vector<CalibratedParameter> parameters;
  Eigen::MatrixXd correlations;      // of the parameters, in their order; empty where it was interrupted
  std::vector<PaperRow> rows;        // at the answer, as the brief experiments give them
  std::vector<RunFit> runs;          // and the measured runs
  double before = 0.0, after = 0.0;  // sum of squared residuals where the search began, and at the answer
  bool kept_start = false;           // nothing better was found than the first guesses
  int evaluations = 0;
  bool interrupted = false;
};

// Share done, -1 where that is not known, and what is being done.
using CalibrationProgress = std::function<void(double share, const std::string& doing)>;

// Begins at the parameters' starts, whatever `question.start` has there. Deterministic, on any number of
// cores.
Calibration calibrate(const Question& question, const CalibrationSettings& settings,
                      const CalibrationProgress& progress = {});

}  // namespace biopsy::sim::calibration
