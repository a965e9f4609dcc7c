#include "sim/gap/select/compare_candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/in_parallel.hpp"
#include "sim/gap/fit/fit.hpp"
#include "sim/gap/residual/predict.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr std::size_t kQuickFits = 9, kLaterQuickFits = 6, kFullFits = 4;
constexpr int kQuickIterations = 5, kFullIterations = 15;
constexpr std::size_t kMostStarts = 3;
constexpr int kAttempts = 3;  // of one start, each weaker:
constexpr double kWeaker = 0.2;
constexpr double kAsPromising = 0.5;  // a further start, where its probe scored this share of the first
constexpr double kHopeless = 4.0;     // mean square over the best rival's, after the first few steps
constexpr double kWorthAFit = 0.1;    // of the best score
constexpr double kTolerance = 0.1;    // of the noise
constexpr double kPlainness =
    1.0;                       // log odds that a number must earn beyond that: of two that fit, the simpler
constexpr double kTwin = 0.3;  // of what the winner explains

Hypothesis with(const Hypothesis& current, const Candidate& candidate, const Probe& probe,
                const Evidence& evidence) {
  Hypothesis out = current;
  if (candidate.effect == kBaseline)
    release(out, candidate.baseline_number);
  else
    include(out, candidate.effect, probe.start, evidence);
  return out;
}

// The best probe of each shape: strengths are found by any fit, shapes are what it gets stuck in.
std::vector<Probe> different_starts(const Score& score) {
  std::vector<Probe> out;
  const auto same_shape = [&](const Probe& a, const Probe& b) {
    const auto& parameters = library()[static_cast<std::size_t>(score.candidate.effect)].parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i)
      if (parameters[i].role != Role::Strength && a.start[i] != b.start[i]) return false;
    return true;
  };
  for (const Probe& probe : score.probes) {
    const bool known =
        std::any_of(out.begin(), out.end(), [&](const Probe& p) { return same_shape(p, probe); });
    if (out.empty() || (!known && out.size() < kMostStarts && probe.share > kAsPromising * score.share()))
      out.push_back(probe);
    if (score.candidate.effect == kBaseline) break;
  }
  return out;
}

// False where nothing of the candidate has a strength.
bool weaken(const Candidate& candidate, Probe& probe) {
  bool any = false;
  if (candidate.effect == kBaseline) return any;
  const auto& parameters = library()[static_cast<std::size_t>(candidate.effect)].parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].role == Role::Strength) probe.start[i] *= kWeaker, any = true;
  return any;
}

// What a simulation that ran away leaves is worse than anything.
double finite(double square) {
  return std::isfinite(square) ? square : std::numeric_limits<double>::infinity();
}

void judge_trial(CandidateFit& trial, Hypothesis hypothesis, const Evidence& evidence) {
  trial.judged = judge(std::move(hypothesis), evidence);
  trial.judged.square = finite(trial.judged.square);
  trial.fitted = true;
}

// One start of one candidate's fit, and where a few steps from it led.
struct Attempt {
  std::size_t trial;
  Probe start;
  Hypothesis reached;
  double square = std::numeric_limits<double>::infinity();  // of the training residuals
};

// A start so strong that its fit ends worse than nothing lies beyond a ridge (a resonance that it moved,
// say): there is a way down from nearer to nothing.
void try_start(Attempt& attempt, const Hypothesis& current, const Candidate& candidate, double nothing,
               const Evidence& evidence) {
  for (int weaker = 0; weaker < kAttempts; ++weaker) {
    Hypothesis fitted = with(current, candidate, attempt.start, evidence);
    fit(fitted, evidence, kQuickIterations);
    const double square = finite(mean_square(residual(fitted.model, evidence, Part::Training)));
    if (weaker == 0 || square < attempt.square) attempt.square = square, attempt.reached = std::move(fitted);
    if (square <= nothing || !weaken(candidate, attempt.start)) return;
  }
}

// Each of the first `count` candidates by the start that got farthest.
void fit_quickly(std::vector<CandidateFit>& fits, const std::vector<Score>& scores, std::size_t count,
                 const Hypothesis& current, const Evidence& evidence, const std::stop_token& stop) {
  std::vector<Attempt> attempts;
  for (std::size_t i = 0; i < count; ++i)
    for (const Probe& start : different_starts(scores[i]))
      attempts.push_back({.trial = i, .start = start, .reached = {}});
  const double nothing = mean_square(residual(current.model, evidence, Part::Training));
  in_parallel(attempts.size(), [&](std::size_t i) {
    if (stop.stop_requested()) return;
    try_start(attempts[i], current, scores[attempts[i].trial].candidate, nothing, evidence);
  });
  if (stop.stop_requested()) return;
  std::stable_sort(attempts.begin(), attempts.end(),
                   [](const Attempt& a, const Attempt& b) { return a.square < b.square; });
  for (Attempt& attempt : attempts)
    if (CandidateFit& trial = fits[attempt.trial]; !trial.fitted)
      judge_trial(trial, std::move(attempt.reached), evidence);
}

double log_evidence(const ScoredModel& judged, double effective_sample_size, const Evidence& evidence) {
  const double tolerated = kTolerance * evidence.noise;
  const bool waves = judged.hypothesis.model.effects.periodic_disturbance.has_value();
  double free = waves ? static_cast<double>(evidence.runs.size()) : 0.0;  // each run has its phase
  for (const Unknown& u : judged.hypothesis.unknowns) free += std::isfinite(u.prior_std) ? 0.0 : 1.0;
  if (!std::isfinite(judged.square)) return -std::numeric_limits<double>::infinity();
  return -0.5 * effective_sample_size * std::log(judged.square + tolerated * tolerated) -
         0.5 * judged.hypothesis.prior_cost() - free * (0.5 * std::log(effective_sample_size) + kPlainness);
}

auto by_square = [](const CandidateFit& a, const CandidateFit& b) {
  return a.judged.square < b.judged.square;
};

// The best to convergence, and those beside it that could still beat it.
void fit_best_well(std::vector<CandidateFit>& fits, std::size_t promising, const Evidence& fine) {
  std::size_t count = std::min(kFullFits, promising);
  while (count > 1 && fits[count - 1].judged.square > kHopeless * fits[0].judged.square) --count;
  in_parallel(count, [&](std::size_t i) {
    Hypothesis better = fits[i].judged.hypothesis;
    fit(better, fine, kFullIterations);
    judge_trial(fits[i], std::move(better), fine);
  });
  // What was only searched on coarse rows is judged on the same rows as the rest.
  in_parallel(promising - count,
              [&](std::size_t i) { judge_trial(fits[count + i], fits[count + i].judged.hypothesis, fine); });
}

void share_probability(Round& round) {
  double top = round.nothing;
  for (const CandidateFit& t : round.fits)
    if (t.fitted) top = std::max(top, t.log_evidence);
  double sum = std::exp(round.nothing - top);
  for (const CandidateFit& t : round.fits)
    if (t.fitted) sum += std::exp(t.log_evidence - top);
  for (CandidateFit& t : round.fits)
    if (t.fitted) t.probability = std::exp(t.log_evidence - top) / sum;
}

// One contains the other: it is no argument against a name that its own special case does nearly as well.
bool are_kin(const Candidate& a, const Candidate& b) {
  return is_dry_friction(a) && is_dry_friction(b);
}

bool predict_the_same(const ScoredModel& a, const ScoredModel& b, double explained) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.residual.size(); ++i) sum += std::pow(a.residual[i] - b.residual[i], 2);
  return sum < kTwin * kTwin * explained * static_cast<double>(a.residual.size());
}

// Kin of the winner, and what predicts the same as the winner or its kin: shaft friction that begins far
// above the needle, say, is Coulomb's under another name.
void mark_indistinguishable(Round& round, const ScoredModel& now) {
  const Candidate& winner = round.fits.front().candidate;
  for (const CandidateFit& one : round.fits) {
    const bool family = one.candidate == winner || are_kin(one.candidate, winner);
    if (!family || !one.fitted || !std::isfinite(one.judged.square)) continue;
    const double explained = std::max(0.0, now.square - one.judged.square);
    for (CandidateFit& t : round.fits)
      if (t.fitted && std::isfinite(t.judged.square) && !(t.candidate == winner))
        t.indistinguishable = t.indistinguishable || t.candidate == one.candidate ||
                              predict_the_same(t.judged, one.judged, explained);
  }
}

std::string names(const std::vector<Score>& scores, std::size_t count, Drive drive) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i) out += (i ? ", " : "") + scores[i].candidate.name(drive);
  return out;
}

}  // namespace

bool is_dry_friction(const Candidate& candidate) {
  if (candidate.effect == kBaseline) return false;
  const std::string_view name = library()[static_cast<std::size_t>(candidate.effect)].info.name;
  return name == CoulombFriction::info.name || name == StribeckFriction::info.name;
}

ScoredModel judge(Hypothesis hypothesis, const Evidence& evidence) {
  ScoredModel out{std::move(hypothesis), {}, 0.0};
  out.residual = residual(out.hypothesis.model, evidence, Part::HeldOut);
  out.square = mean_square(out.residual);
  return out;
}

double held_out_effective_sample_size(const Evidence& evidence) {
  double windows = 0.0;
  for (const EvidenceRun& run : evidence.runs)
    if (run.training_rows < run.rows.size()) windows += static_cast<double>(run.windows.size());
  return windows > 0.0 ? windows : independent_looks(evidence.held_out_seconds);
}

Round selection_step(const ScoredModel& now, const Evidence& coarse, const Evidence& fine,
                     const RoundName& name, const Progress& progress, const std::stop_token& stop) {
  const std::vector<Candidate> open = open_candidates(now.hypothesis);
  progress(name.share, fmt::format("{}: score test of {} candidates", name.title, open.size()));
  const std::vector<Score> scores = score_candidates(now.hypothesis, coarse, open);
  if (stop.stop_requested()) return {};
  const std::size_t most = std::min(name.number > 1 ? kLaterQuickFits : kQuickFits, scores.size());
  std::size_t promising = 0;
  while (promising < most && scores[promising].share() > kWorthAFit * scores.front().share() &&
         scores[promising].share() > 0.0)
    ++promising;
  Round round;
  for (const Score& score : scores)
    round.fits.push_back(
        {.candidate = score.candidate, .round = name.number, .share = score.share(), .judged = {}});
  progress(0.7 * name.share + 0.3 * name.share_after,
           fmt::format("{}: fitting {}", name.title, names(scores, promising, now.drive())));
  fit_quickly(round.fits, scores, promising, now.hypothesis, coarse, stop);
  if (stop.stop_requested()) return {};
  const auto end = round.fits.begin() + static_cast<std::ptrdiff_t>(promising);
  std::stable_sort(round.fits.begin(), end, by_square);
  fit_best_well(round.fits, promising, fine);
  std::stable_sort(round.fits.begin(), end, by_square);
  if (promising == 0) return round;
  const double effective_sample_size = held_out_effective_sample_size(fine);
  round.nothing = log_evidence(now, effective_sample_size, fine);
  for (CandidateFit& t : round.fits)
    if (t.fitted) t.log_evidence = log_evidence(t.judged, effective_sample_size, fine);
  std::stable_sort(round.fits.begin(), end, [](const CandidateFit& a, const CandidateFit& b) {
    return a.log_evidence > b.log_evidence;
  });
  share_probability(round);
  mark_indistinguishable(round, now);
  return round;
}

}  // namespace biopsy::sim::gap
