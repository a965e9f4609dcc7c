// Forward selection: which candidate explains the gap, and is it anything at all? Held-out runs decide.
//
// Evidence of a hypothesis = -effective_sample_size/2 ln(held-out mean square) - prior cost/2 - free numbers
// (ln(effective_sample_size)/2 + 1): the Bayesian information criterion with an effective sample size.
// Residuals of a wrong model are correlated, and counting each reading would take every candidate that comes
// along; `effective_sample_size` counts stretches that err on their own (independent_looks). A tenth of the
// noise is tolerated, so that a difference between integrators is nobody's effect.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "sim/gap/residual/score.hpp"

namespace biopsy::sim::gap {

// A hypothesis, fitted on the training runs and judged on the others.
struct ScoredModel {
  Hypothesis hypothesis;
  std::vector<double> residual;  // m, held-out rows
  double square = 0.0;           // m^2, its mean square

  Drive drive() const { return hypothesis.model.baseline.drive; }
};

// One candidate, tried: with its fit where the score test let it through.
struct CandidateFit {
  Candidate candidate;
  int round = 1;
  double share = 0.0;  // of the training gap, by the score test
  bool fitted = false;
  ScoredModel judged;
  double log_evidence = 0.0;
  double probability = 0.0;  // in its round, among all candidates and "nothing"
  bool chosen = false;
  bool indistinguishable = false;  // predicts what the winner, or a special case of it, predicts
};

// What entered, and the last contest for its place: all candidates in the company of the others that entered.
struct SelectedTerm {
  Candidate candidate;
  double reduction = 0.0;  // of the excess square that was left
  std::vector<CandidateFit> contest;

  bool is_effect() const { return candidate.effect != kBaseline; }
};

struct Selection {
  ScoredModel start;  // the model with calibration errors only
  ScoredModel best;
  std::vector<CandidateFit> fits;  // of all rounds
  std::vector<SelectedTerm> selected;
};

// `share`: of the work, in [0, 1]; an estimate, because nobody knows how many rounds there will be.
using Progress = std::function<void(double share, const std::string& doing)>;

ScoredModel judge(Hypothesis hypothesis, const Evidence& evidence);

// What is above the noise of a mean square; m^2, at least 0.
double excess(double square, const Evidence& evidence);
// Whether that much above the noise is not worth a name.
bool is_only_noise(double square, const Evidence& evidence);

// Coarse evidence to search on, fine to fit and judge on.
inline constexpr std::size_t kMostEffects = 3;
// A round that `stop` interrupts is left out.
Selection select(Hypothesis start, const Evidence& coarse, const Evidence& fine, const Progress& progress,
                 std::size_t most_effects = kMostEffects, const std::stop_token& stop = {});

}  // namespace biopsy::sim::gap
