// The cheap look before any fit: were this effect put in at a strength that matters, how much of the gap
// would go away? Each probe is one shape of the effect; its response is fitted to what the calibration errors
// leave of the residual.
#pragma once

#include "sim/gap/fit/unknowns.hpp"

namespace biopsy::sim::gap {

// A candidate: an effect of the library, or a number of the baseline let go.
struct Candidate {
  int effect = kBaseline;
  std::size_t baseline_number = 0;  // where effect == kBaseline

  std::string name(Drive drive) const;
  bool operator==(const Candidate&) const = default;
};

struct Probe {
  std::vector<double> start;  // SI values of the effect's parameters; empty for a number of the baseline
  double share = 0.0;         // of the training gap that it promises to explain
};

struct Score {
  Candidate candidate;
  std::vector<Probe> probes;  // most promising first

  double share() const { return probes.empty() ? 0.0 : probes.front().share; }
};

// What the model does not have and a baseline's numbers that are not free yet.
std::vector<Candidate> open_candidates(const Hypothesis& current);

// Every candidate against the residual of the current hypothesis, best first. Uses all cores.
std::vector<Score> score_candidates(const Hypothesis& current, const Evidence& evidence,
                                    const std::vector<Candidate>& candidates);

}  // namespace biopsy::sim::gap
