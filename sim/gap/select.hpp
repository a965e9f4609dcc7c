// Forward selection: which candidate explains the gap, and is it anything at all? Held-out runs decide.
//
// Evidence of a hypothesis = -looks/2 ln(held-out mean square) - prior cost/2 - free numbers/2 ln(looks): the
// Bayesian information criterion with an effective sample size (one look per response time of the stage, see
// independent_looks), because residuals of a wrong model are correlated and white-noise BIC then takes
// every candidate that comes along. A tenth of the noise is tolerated, so that differences between integrators are nobody's
// effect.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/gap/score.hpp"

namespace biopsy::sim::gap {

// One candidate, tried: with its fit where the score test let it through.
struct Trial {
  Candidate candidate;
  int round = 1;
  double share = 0.0;  // of the training gap, by the score test
  bool fitted = false;
  Hypothesis hypothesis;
  double held_out_square = 0.0;  // m^2, mean
  double log_evidence = 0.0;
  double probability = 0.0;  // in its round, among all candidates and "nothing"
  bool chosen = false;
};

struct Selection {
  Hypothesis start;    // the model with calibration errors only
  Hypothesis best;
  std::vector<Trial> trials;        // of all rounds
  std::vector<Candidate> chosen;    // in the order of entering
  std::vector<double> squares;      // held-out mean square before the first, after each chosen
  std::vector<Trial> rivals;        // the last contest for each chosen: it replaced by another
};

using Progress = std::function<void(const std::string& doing)>;

double held_out_square(const PlantModel& model, const Evidence& evidence);
double log_evidence(const Hypothesis& hypothesis, const Evidence& evidence, double held_out_square);

// What is above the noise of a mean square; m^2, at least 0.
double excess(double square, const Evidence& evidence);
// Whether that much above the noise is not worth a name.
bool is_only_noise(double square, const Evidence& evidence);

Selection select(Hypothesis start, const Evidence& coarse, const Evidence& fine, const Progress& progress);

}  // namespace biopsy::sim::gap
