// Forward selection of the candidates that explain the gap, decided on the held-out runs.
//
// Log evidence of a hypothesis = -N/2 ln(held-out mean square) - prior cost/2 - (free parameters) (ln(N)/2 +
// 1), N the effective sample size: the Bayesian information criterion. Residuals of a wrong model are
// correlated; with N = number of readings nearly every candidate would be accepted. A tenth of the noise is
// tolerated, so that differences between integrators are not attributed to an effect. Where the held-out runs
// show too little to decide, both halves do (exchange.hpp).
#pragma once

#include <functional>
#include <limits>
#include <stop_token>
#include <string>
#include <vector>

#include "sim/gap/residual/score.hpp"

namespace biopsy::sim::gap {

// A hypothesis fitted on the training runs, with its residual on the others.
struct ScoredModel {
  Hypothesis hypothesis;
  std::vector<double> residual;  // m, held-out rows
  double square = 0.0;           // m^2, its mean square

  Drive drive() const { return hypothesis.model.baseline.drive; }
};

// One candidate; with a fit where it passed the score test.
struct CandidateFit {
  Candidate candidate;
  int round = 1;
  double share = 0.0;  // of the training gap, by the score test
  bool fitted = false;
  ScoredModel scored;
  double log_evidence = 0.0;
  double paired = 0.0;       // of it: told_apart.hpp
  double probability = 0.0;  // in its round, among all candidates and the unchanged model
  bool chosen = false;
  bool indistinguishable = false;  // predicts the same as the winner or a model nested with it
  double exchanged_square = std::numeric_limits<double>::quiet_NaN();  // m^2: exchange.hpp; NaN: not needed
};

// A selected candidate, and the last comparison that it won, the other selected terms being in the model.
struct SelectedTerm {
  Candidate candidate;
  double reduction = 0.0;  // of the excess square that was left
  std::vector<CandidateFit> comparison;

  bool is_effect() const { return candidate.effect != kBaseline; }
};

struct Selection {
  ScoredModel start;  // the model with calibration errors only
  ScoredModel best;
  std::vector<CandidateFit> fits;  // of all rounds
  std::vector<SelectedTerm> selected;
  bool cut_short = false;                    // is_exhausted() left something out
  bool by_both = false;                      // the held-out runs could not decide alone: exchange.hpp
  std::vector<std::string> objections = {};  // to naming what was selected: objections.hpp
};

// `share`: of the work, in [0, 1]; an estimate: the number of rounds is not known in advance.
using Progress = std::function<void(double share, const std::string& doing)>;

ScoredModel score_model(Hypothesis hypothesis, const Evidence& evidence);

// Mean square above that of the noise; m^2, at least 0.
double excess(double square, const Evidence& evidence);
// Whether that excess is too small to be attributed to anything.
bool is_only_noise(double square, const Evidence& evidence);

// Whether the search has simulated so much that nothing further is begun.
bool is_exhausted(const Evidence& evidence);

// Searches on coarse rows, fits and compares on fine ones.
inline constexpr std::size_t kMostEffects = 3;
// A round that `stop` interrupts is left out.
Selection select(Hypothesis start, const Evidence& coarse, const Evidence& fine, const Progress& progress,
                 std::size_t most_effects = kMostEffects, const std::stop_token& stop = {});

}  // namespace biopsy::sim::gap
