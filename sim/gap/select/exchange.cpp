#include "sim/gap/select/exchange.hpp"

#include <algorithm>
#include <cmath>

#include "robot/common/in_parallel.hpp"
#include "sim/gap/fit/fit.hpp"
#include "sim/gap/residual/predict.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kOpen = 10.0;      // log evidence behind the best: what the other half may yet turn
constexpr std::size_t kMost = 4;    // candidates
constexpr double kNotWorse = 1.05;  // held-out mean square
constexpr int kIterations = 15;

double both(double held_out, double training, const Evidence& fine) {
  if (!std::isfinite(training)) return held_out;
  return (held_out * fine.held_out_seconds + training * fine.training_seconds) /
         (fine.held_out_seconds + fine.training_seconds);
}

ScoredModel refitted(Hypothesis hypothesis, const Evidence& other) {
  fit_closely(hypothesis, other, kIterations);
  return score_model(std::move(hypothesis), other);
}

}  // namespace

bool can_exchange(const Evidence& evidence) {
  return std::ranges::none_of(evidence.runs, [](const EvidenceRun& run) {
    return run.training_rows > 0 && run.training_rows < run.rows.size();
  });
}

Evidence exchanged(Evidence evidence) {
  for (EvidenceRun& run : evidence.runs) run.training_rows = run.training_rows > 0 ? 0 : run.rows.size();
  std::swap(evidence.training_seconds, evidence.held_out_seconds);
  return evidence;
}

bool judge_by_both(Round& round, const ScoredModel& now, const Evidence& fine) {
  if (!can_exchange(fine)) return false;
  if (round.fits.empty() || !round.fits.front().fitted) return false;
  if (!(round.fits.front().scored.square < kNotWorse * now.square)) return false;
  if (is_only_noise(mean_square(residual(now.hypothesis.model, fine, Part::Training)), fine)) return false;
  std::size_t open = 0;
  const double least = round.fits.front().log_evidence - kOpen;
  while (open < std::min(kMost, round.fits.size()) && round.fits[open].fitted &&
         round.fits[open].log_evidence > least)
    ++open;
  const Evidence other = exchanged(fine);
  const ScoredModel null = refitted(now.hypothesis, other);
  std::vector<ScoredModel> fits(open);
  in_parallel(open, [&](std::size_t i) { fits[i] = refitted(round.fits[i].scored.hypothesis, other); });
  const double null_evidence = log_evidence(null, other);
  for (std::size_t i = 0; i < round.fits.size(); ++i) {
    CandidateFit& one = round.fits[i];
    one.exchanged_square = i < open ? fits[i].square : null.square;
    one.log_evidence += i < open ? log_evidence(fits[i], other) : null_evidence;
  }
  round.null_evidence += null_evidence;
  round.exchanged_null_square = null.square;
  rank(round, now, fine);
  return true;
}

double square_of_both(const CandidateFit& fit, const Evidence& fine) {
  return both(fit.scored.square, fit.exchanged_square, fine);
}

double square_of_both(const ScoredModel& now, const Round& round, const Evidence& fine) {
  return both(now.square, round.exchanged_null_square, fine);
}

}  // namespace biopsy::sim::gap
