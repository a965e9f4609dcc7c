// One step of the forward selection: every open candidate is scored against the present hypothesis, the
// promising ones are fitted on coarse rows, the best to convergence, and all are compared on the held-out
// runs.
#pragma once

#include <limits>
#include <string_view>

#include "sim/gap/select/select.hpp"

namespace biopsy::sim::gap {

struct Round {
  std::vector<CandidateFit> fits;  // best first
  double null_evidence = 0.0;      // log evidence of the present hypothesis
  double exchanged_null_square = std::numeric_limits<double>::quiet_NaN();  // m^2, of it: exchange.hpp
};

// The fits by their log evidence, with probabilities and what cannot be told apart. `evidence`: what they are
// scored on.
void rank(Round& round, const ScoredModel& now, const Evidence& evidence);

double log_evidence(const ScoredModel& scored, const Evidence& evidence);

// Where the held-out runs do not decide, the training runs do: of those that come near the first, all but the
// one that explains the training runs best fall behind by what they lack there.
void let_training_decide(Round& round, const Evidence& evidence);

struct RoundName {
  int number = 1;
  std::string title;
  double share = 0.0, share_after = 0.0;  // of the work, before and after it
};

// Candidates of a step: these, all if there are none. What leaves far more than `known` is not fitted fully.
struct Rivals {
  std::vector<Candidate> among;
  double known = std::numeric_limits<double>::infinity();  // m^2
};

// Without fits where `stop` interrupted it.
Round selection_step(const ScoredModel& now, const Evidence& coarse, const Evidence& fine,
                     const RoundName& name, const Progress& progress, const std::stop_token& stop,
                     const Rivals& rivals = {});

// The effect of the library with that name.
bool is_effect(const Candidate& candidate, std::string_view name);

// Coulomb or Stribeck friction between plate A and its guide.
bool is_dry_friction(const Candidate& candidate);

// A law that many others resemble. It is a name where it leaves hardly more than noise, and no rival
// elsewhere.
bool resembles_many(const Candidate& candidate);
inline constexpr double kHardlyMore = 0.5;  // noises that it may leave

// Number of independent errors in the held-out runs: one per window where runs are cut into windows,
// otherwise by independent_samples().
double held_out_effective_sample_size(const Evidence& evidence);

}  // namespace biopsy::sim::gap
