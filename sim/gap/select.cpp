#include "sim/gap/select.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/gap/fit.hpp"
#include "sim/gap/in_parallel.hpp"
#include "sim/gap/predict.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr int kMostEffects = 3, kMostRounds = 5;
constexpr std::size_t kQuickFits = 9, kFullFits = 4;
constexpr int kQuickIterations = 5, kFullIterations = 25;
constexpr double kWorthAFit = 0.1;         // of the best score
constexpr double kNeededEvidence = 10.0;   // odds of 20000 to 1: the whole library gets its say at 5 %
constexpr double kNeededReduction = 0.25;  // of the excess square that is left
constexpr double kTolerance = 0.1;         // of the noise
constexpr double kOnlyNoise = 0.25;        // excess below this share of the noise changes no RMSE by 4 %

Hypothesis with(const Hypothesis& current, const Candidate& candidate, const Probe& probe,
                const Evidence& evidence) {
  Hypothesis out = current;
  if (candidate.effect == kBaseline) release(out, candidate.baseline_number);
  else include(out, candidate.effect, probe.start, evidence);
  return out;
}

void judge(Trial& trial, const Evidence& evidence) {
  trial.held_out_square = held_out_square(trial.hypothesis.model, evidence);
  trial.log_evidence = log_evidence(trial.hypothesis, evidence, trial.held_out_square);
  trial.fitted = true;
}

double training_cost(const Trial& trial, const Evidence& evidence) {
  return mean_square(residual(trial.hypothesis.model, evidence, Part::Training));
}

// A few steps from the best probe, and from the second best where that is another shape.
void quick_fit(Trial& trial, const Hypothesis& current, const Score& score, const Evidence& evidence) {
  const std::size_t starts = std::min<std::size_t>(score.candidate.effect == kBaseline ? 1 : 2, score.probes.size());
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < starts; ++i) {
    Trial attempt = trial;
    attempt.hypothesis = with(current, score.candidate, score.probes[i], evidence);
    fit(attempt.hypothesis, evidence, kQuickIterations);
    const double cost = training_cost(attempt, evidence);
    if (cost < least) least = cost, trial.hypothesis = attempt.hypothesis;
  }
}

void share_probability(std::vector<Trial>& trials, double nothing) {
  double top = nothing;
  for (const Trial& t : trials)
    if (t.fitted) top = std::max(top, t.log_evidence);
  double sum = std::exp(nothing - top);
  for (const Trial& t : trials)
    if (t.fitted) sum += std::exp(t.log_evidence - top);
  for (Trial& t : trials)
    if (t.fitted) t.probability = std::exp(t.log_evidence - top) / sum;
}

std::string names(const std::vector<Score>& scores, std::size_t count, Drive drive) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i) out += (i ? ", " : "") + scores[i].candidate.name(drive);
  return out;
}

// All candidates against the current hypothesis: scored, the promising fitted, the best fitted well.
std::vector<Trial> hold_round(const Hypothesis& current, double current_evidence, const Evidence& coarse,
                              const Evidence& fine, int round, const Progress& progress) {
  const std::vector<Candidate> open = open_candidates(current);
  const Drive drive = current.model.baseline.drive;
  progress(fmt::format("round {}: score test of {} candidates", round, open.size()));
  const std::vector<Score> scores = score_candidates(current, coarse, open);
  std::size_t promising = 0;
  while (promising < std::min(kQuickFits, scores.size()) &&
         scores[promising].share() > kWorthAFit * scores.front().share() && scores[promising].share() > 0.0)
    ++promising;
  std::vector<Trial> trials;
  for (const Score& score : scores)
    trials.push_back({.candidate = score.candidate, .round = round, .share = score.share(), .hypothesis = {}});
  progress(fmt::format("round {}: fitting {}", round, names(scores, promising, drive)));
  in_parallel(promising, [&](std::size_t i) {
    quick_fit(trials[i], current, scores[i], coarse);
    judge(trials[i], coarse);
  });
  std::stable_sort(trials.begin(), trials.begin() + static_cast<std::ptrdiff_t>(promising),
                   [](const Trial& a, const Trial& b) { return a.log_evidence > b.log_evidence; });
  in_parallel(std::min(kFullFits, promising), [&](std::size_t i) {
    fit(trials[i].hypothesis, fine, kFullIterations);
    judge(trials[i], fine);
  });
  std::stable_sort(trials.begin(), trials.begin() + static_cast<std::ptrdiff_t>(promising),
                   [](const Trial& a, const Trial& b) { return a.log_evidence > b.log_evidence; });
  share_probability(trials, current_evidence);
  return trials;
}

bool convinces(const Trial& trial, double evidence_now, double square_now, const Evidence& evidence) {
  return trial.fitted && trial.log_evidence > evidence_now + kNeededEvidence &&
         excess(trial.held_out_square, evidence) < (1.0 - kNeededReduction) * excess(square_now, evidence);
}

}  // namespace

double held_out_square(const PlantModel& model, const Evidence& evidence) {
  return mean_square(residual(model, evidence, Part::HeldOut));
}

double log_evidence(const Hypothesis& hypothesis, const Evidence& evidence, double square) {
  const double looks = independent_looks(evidence.held_out_seconds);
  const double tolerated = kTolerance * evidence.noise;
  double free = 0.0;
  for (const Unknown& u : hypothesis.unknowns) free += std::isfinite(u.prior_std) ? 0.0 : 1.0;
  return -0.5 * looks * std::log(square + tolerated * tolerated) - 0.5 * hypothesis.prior_cost() -
         0.5 * free * std::log(looks);
}

double excess(double square, const Evidence& evidence) {
  return std::max(0.0, square - evidence.noise * evidence.noise);
}

bool is_only_noise(double square, const Evidence& evidence) {
  return std::sqrt(excess(square, evidence)) < kOnlyNoise * evidence.noise;
}

Selection select(Hypothesis start, const Evidence& coarse, const Evidence& fine,
                 const Progress& progress) {
  Selection out{.start = start, .best = start, .trials = {}, .chosen = {}, .squares = {}, .rivals = {}};
  double square = held_out_square(start.model, fine);
  double now = log_evidence(start, evidence, square);
  out.squares.push_back(square);
  int effects = 0;
  for (int round = 1; round <= kMostRounds && effects < kMostEffects && !is_only_noise(square, fine); ++round) {
    std::vector<Trial> trials = hold_round(out.best, now, coarse, fine, round, progress);
    const bool found = !trials.empty() && convinces(trials.front(), now, square, fine);
    if (found) {
      Trial& winner = trials.front();
      winner.chosen = true;
      out.best = winner.hypothesis;
      out.chosen.push_back(winner.candidate);
      square = winner.held_out_square, now = winner.log_evidence;
      out.squares.push_back(square);
      if (winner.candidate.effect != kBaseline) ++effects;
    }
    out.trials.insert(out.trials.end(), trials.begin(), trials.end());
    if (!found) break;
  }
  return out;
}

}  // namespace biopsy::sim::gap
