// Score test, before any fit: how much of the gap would the linear response to a candidate explain? Each
// probe is one shape of the effect; its response is fitted to the residual that calibration errors cannot
// explain.
#pragma once

#include "sim/gap/fit/unknowns.hpp"

namespace biopsy::sim::gap {

// A candidate: an effect of the library, or a baseline parameter without its prior.
struct Candidate {
  int effect = kBaseline;
  std::size_t baseline_parameter = 0;  // where effect == kBaseline

  std::string name(Drive drive) const;
  bool operator==(const Candidate&) const = default;
};

struct Probe {
  std::vector<double> start;  // SI values of the effect's parameters; empty for a baseline parameter
  double share = 0.0;         // of the squared training residual that the response explains
};

struct Score {
  Candidate candidate;
  std::vector<Probe> probes;  // best first

  double share() const { return probes.empty() ? 0.0 : probes.front().share; }
};

// Effects that the model does not have and that can be there (of tissue only with `tissue`), and baseline
// parameters that still have a prior.
std::vector<Candidate> open_candidates(const Hypothesis& current, bool tissue);

// All candidates against the residual of the current hypothesis, best first. Uses all cores.
std::vector<Score> score_candidates(const Hypothesis& current, const Evidence& evidence,
                                    const std::vector<Candidate>& candidates);

}  // namespace biopsy::sim::gap
