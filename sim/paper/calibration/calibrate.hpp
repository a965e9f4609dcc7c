// One parameter set for all of the paper's figures: from far away several starts along the rows'
// sensitivities, then CMA-ES, last steps along the sensitivities again, and from them the standard
// deviations.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "sim/paper/calibration/cma_es.hpp"
#include "sim/paper/calibration/identifiability.hpp"
#include "sim/paper/calibration/objective.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::sim::calibration {

// Budgets in evaluations and not in time, so that the result is reproducible. spread: std of the first draws
// of CMA-ES, in prior stds.
struct CalibrationSettings {
  int starts = 0;     // of a first search from far away: the start and draws around it; 0: none
  int far_steps = 6;  // Levenberg-Marquardt from each of them, with Pull::Even, and again with Pull::Robust
  int evaluations = 600;  // of CMA-ES, from the best of them
  int last_steps = 3;     // Levenberg-Marquardt with central differences
  std::uint64_t seed = 1;
  int population = 16;
  double spread = 0.2;
  std::stop_token stop = {};  // ends the search with the best until then; standard deviations stay unknown
};

struct CalibratedParameter {
  Parameter parameter;
  double value = 0.0, std = 0.0;  // file units; std is NaN where the search was interrupted
  bool at_bound = false;          // the optimum is outside the plausible range
  bool only_prior = false;        // not identifiable from the figures: std at least 0.9 of the prior's
};

struct Calibration {
  paper::PaperModel model;
  std::vector<CalibratedParameter> parameters;
  Eigen::MatrixXd correlations;      // of the parameters, in their order; empty where it was interrupted
  Identifiability identifiability;   // likewise
  std::vector<PaperRow> rows;        // at the result, by the shortened experiments
  std::vector<RunFit> runs;          // and the measured runs
  double before = 0.0, after = 0.0;  // sum of squared residuals at the start and at the result
  bool kept_start = false;           // no better point than the start was found
  int evaluations = 0;
  bool interrupted = false;
};

// Share done, -1 where that is not known, and what is being done.
using CalibrationProgress = std::function<void(double share, const std::string& doing)>;

// Starts at the parameters' starts, independent of their values in `question.start`. Deterministic, on any
// number of cores.
Calibration calibrate(const Question& question, const CalibrationSettings& settings,
                      const CalibrationProgress& progress = {});

}  // namespace biopsy::sim::calibration
