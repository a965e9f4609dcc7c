#include "sim/gap/select/compare_candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "robot/common/in_parallel.hpp"
#include "sim/gap/fit/fit.hpp"
#include "sim/gap/fit/probes.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/select/keep_simpler.hpp"
#include "sim/gap/select/told_apart.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr std::size_t kQuickFits = 9, kLaterQuickFits = 6, kFullFits = 4, kCloseFits = 2;
constexpr int kQuickIterations = 5, kFullIterations = 15;
constexpr double kQuickConverged = 1e-2, kFullConverged = 1e-3;  // of the cost: an order needs no more
constexpr std::size_t kMostStarts = 3, kMostRoughStarts = 8;     // of a cost with many minima
constexpr int kAttempts = 3;  // for one start, each with strengths times kWeaker
constexpr double kWeaker = 0.2;
constexpr double kAsPromising = 0.5;   // share of the first probe's score that justifies a further start
constexpr double kWorthAnother = 0.4;  // and of the best candidate's
constexpr double kLeads = 0.8;         // of the best candidate's, for more starts of a rough cost
constexpr std::array kOtherStrengths{0.4, 2.5, -1.0, 0.16, 6.25};  // of what shifts a resonance
constexpr double kClosed = 0.0025;          // of the excess square: other starts gain nothing that matters
constexpr double kFarWorse = 4.0;           // mean square over the best one's after the quick fits
constexpr double kWorthFitting = 0.1;       // of the best score
constexpr double kTolerance = 0.1;          // of the noise
constexpr double kComplexityPenalty = 1.0;  // log odds for each free parameter, beyond the BIC's
constexpr double kSamePrediction = 0.3;     // RMS difference, of what the winner explains
constexpr double kOpen = 10.0;              // log evidence within which candidates are not told apart
constexpr double kUndecided = 3.0;          // and within which held-out runs do not decide: odds of 20 to 1

Hypothesis with(const Hypothesis& current, const Candidate& candidate, const Probe& probe,
                const Evidence& evidence) {
  Hypothesis out = current;
  if (candidate.effect == kBaseline)
    free_parameter(out, candidate.baseline_parameter);
  else
    add_effect(out, candidate.effect, probe.start, evidence);
  return out;
}

// The best probe of each shape: a fit finds the strengths from anywhere, but may converge to a wrong shape.
// `promised`: by the best candidate's best probe.
std::vector<Probe> different_starts(const Score& score, double promised, Drive drive) {
  std::vector<Probe> out;
  const auto same_shape = [&](const Probe& a, const Probe& b) {
    const auto& parameters = library_effect(score.candidate.effect).parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i)
      if (parameters[i].role != Role::Strength && a.start[i] != b.start[i]) return false;
    return true;
  };
  const bool rough = score.candidate.effect != kBaseline &&
                     gives_way(library_effect(score.candidate.effect)) && score.share() > kLeads * promised;
  const std::size_t most = rough ? kMostRoughStarts : kMostStarts;
  for (const Probe& probe : score.probes) {
    const bool known =
        std::any_of(out.begin(), out.end(), [&](const Probe& p) { return same_shape(p, probe); });
    const bool promising = probe.share > std::max(kAsPromising * score.share(), kWorthAnother * promised);
    if (out.empty() || (!known && out.size() < most && promising)) out.push_back(probe);
    if (score.candidate.effect == kBaseline) break;
  }
  // A lightly damped mechanism is soon far out of step: then no score says which strength is near.
  const bool open = drive == Drive::Force || score.share() > kLeads * promised;
  if (open && is_effect(score.candidate, SpringHardening::info.name))
    for (const double factor : kOtherStrengths) {
      out.push_back(out.front());
      for (double& strength : out.back().start) strength *= factor;
    }
  return out;
}

// False where the candidate has no strength parameter.
bool weaken(const Candidate& candidate, Probe& probe) {
  bool any = false;
  if (candidate.effect == kBaseline) return any;
  const auto& parameters = library_effect(candidate.effect).parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].role == Role::Strength) probe.start[i] *= kWeaker, any = true;
  return any;
}

void set_fit(CandidateFit& out, Hypothesis hypothesis, const Evidence& evidence) {
  out.scored = score_model(std::move(hypothesis), evidence);
  out.fitted = true;
}

// A quick fit of one candidate from one start.
struct Attempt {
  std::size_t candidate;
  Probe start;
  Hypothesis reached;
  double square = std::numeric_limits<double>::infinity();  // of the training residuals
};

// A fit that ends worse than the present model started too strong, beyond a ridge of the cost (for example a
// resonance that it shifted): it is tried again from weaker starts.
void try_start(Attempt& attempt, const Hypothesis& current, const Candidate& candidate, double square_now,
               const Evidence& evidence) {
  for (int weaker = 0; weaker < kAttempts; ++weaker) {
    Hypothesis fitted = with(current, candidate, attempt.start, evidence);
    const double square = fit(fitted, evidence, kQuickIterations, 1.0, kQuickConverged);
    if (weaker == 0 || square < attempt.square) attempt.square = square, attempt.reached = std::move(fitted);
    if (square <= square_now || !weaken(candidate, attempt.start)) return;
  }
}

// Each of the first `count` candidates, from its best start.
void fit_quickly(std::vector<CandidateFit>& fits, const std::vector<Score>& scores, std::size_t count,
                 const Hypothesis& current, const Evidence& evidence, const std::stop_token& stop) {
  std::vector<Attempt> attempts;
  const double square_now = mean_square(residual(current.model, evidence, Part::Training));
  // The best start of each first.
  const auto enough = [&] {  // one has closed the gap, or simulating has cost too much
    return is_exhausted(evidence) || std::ranges::any_of(attempts, [&](const Attempt& attempt) {
             if (resembles_many(scores[attempt.candidate].candidate)) return false;
             return is_only_noise(attempt.square, evidence) ||
                    excess(attempt.square, evidence) < kClosed * excess(square_now, evidence);
           });
  };
  for (std::size_t nth = 0; nth < kMostRoughStarts && (nth == 0 || !enough()); ++nth) {
    const std::size_t begun = attempts.size();
    for (std::size_t i = 0; i < count; ++i)
      if (const auto starts =
              different_starts(scores[i], scores.front().share(), current.model.baseline.drive);
          nth < starts.size())
        attempts.push_back({.candidate = i, .start = starts[nth], .reached = {}});
    in_parallel(attempts.size() - begun, [&](std::size_t i) {
      Attempt& attempt = attempts[begun + i];
      if (!stop.stop_requested())
        try_start(attempt, current, scores[attempt.candidate].candidate, square_now, evidence);
    });
    if (stop.stop_requested()) return;
  }
  std::stable_sort(attempts.begin(), attempts.end(),
                   [](const Attempt& a, const Attempt& b) { return a.square < b.square; });
  for (Attempt& attempt : attempts)
    if (CandidateFit& out = fits[attempt.candidate]; !out.fitted)
      set_fit(out, std::move(attempt.reached), evidence);
}

auto by_square = [](const CandidateFit& a, const CandidateFit& b) {
  return a.scored.square < b.scored.square;
};

// How many of the first `count`, in order, are not far worse than the best or than `known` [m^2].
std::size_t near_the_best(const std::vector<CandidateFit>& fits, std::size_t count, double known) {
  const auto far = [&](const CandidateFit& t) {
    return t.scored.square > kFarWorse * std::min(known, fits[0].scored.square);
  };
  while (count > 0 && far(fits[count - 1])) --count;
  return count;
}

// Those that could still overtake the best: nearly to convergence on coarse rows, the first of them then on
// fine ones, on which all are compared. Bristles that bend unseen are the friction that they contain.
void fit_best_fully(std::vector<CandidateFit>& fits, std::size_t promising, double known,
                    const Evidence& coarse, const Evidence& fine) {
  const auto end = fits.begin() + static_cast<std::ptrdiff_t>(promising);
  const auto seen_end = std::stable_partition(
      fits.begin(), end, [&](const CandidateFit& t) { return !bends_unseen(t, coarse); });
  const auto seen = static_cast<std::size_t>(seen_end - fits.begin());
  const std::size_t most = is_exhausted(fine) ? kCloseFits : kFullFits;
  const std::size_t open = near_the_best(fits, std::min(most, seen), known);
  in_parallel(promising, [&](std::size_t i) {
    Hypothesis better = fits[i].scored.hypothesis;
    if (i < open) fit(better, coarse, kFullIterations, 1.0, kFullConverged);
    set_fit(fits[i], std::move(better), fine);
  });
  std::stable_sort(fits.begin(), fits.begin() + static_cast<std::ptrdiff_t>(open), by_square);
  in_parallel(near_the_best(fits, std::min(kCloseFits, open), known), [&](std::size_t i) {
    Hypothesis better = fits[i].scored.hypothesis;
    fit_closely(better, fine, kFullIterations);
    set_fit(fits[i], std::move(better), fine);
  });
}

void normalise_probabilities(Round& round) {
  double top = round.null_evidence;
  for (const CandidateFit& t : round.fits)
    if (t.fitted) top = std::max(top, t.log_evidence);
  double sum = std::exp(round.null_evidence - top);
  for (const CandidateFit& t : round.fits)
    if (t.fitted) sum += std::exp(t.log_evidence - top);
  for (CandidateFit& t : round.fits)
    if (t.fitted) t.probability = std::exp(t.log_evidence - top) / sum;
}

// One model contains the other: that a special case does nearly as well does not count against a name.
bool are_nested(const Candidate& a, const Candidate& b) {
  return is_dry_friction(a) && is_dry_friction(b);
}

bool similar_predictions(const ScoredModel& a, const ScoredModel& b, double explained) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.residual.size(); ++i) sum += std::pow(a.residual[i] - b.residual[i], 2);
  return sum < kSamePrediction * kSamePrediction * explained * static_cast<double>(a.residual.size());
}

// Candidates nested with the winner, and those that predict the same as any of these: shaft friction that
// begins far above the needle, for example, is Coulomb friction.
void mark_indistinguishable(Round& round, const ScoredModel& now) {
  const Candidate& winner = round.fits.front().candidate;
  for (const CandidateFit& one : round.fits) {
    const bool nested = one.candidate == winner || are_nested(one.candidate, winner);
    if (!nested || !one.fitted || !std::isfinite(one.scored.square)) continue;
    const double explained = std::isfinite(now.square) ? std::max(0.0, now.square - one.scored.square) : 0.0;
    for (CandidateFit& t : round.fits)
      if (t.fitted && std::isfinite(t.scored.square) && !(t.candidate == winner))
        t.indistinguishable = t.indistinguishable || t.candidate == one.candidate ||
                              similar_predictions(t.scored, one.scored, explained);
  }
}

void sort_by_evidence(Round& round) {
  std::stable_sort(round.fits.begin(), round.fits.end(), [](const CandidateFit& a, const CandidateFit& b) {
    return a.fitted != b.fitted ? a.fitted : a.fitted && a.log_evidence > b.log_evidence;
  });
}

// What the evidence leaves open against the first is decided by the differences between their errors.
void prefer_told_apart(Round& round, const Evidence& evidence) {
  if (round.fits.empty() || !round.fits.front().fitted) return;
  const CandidateFit first = round.fits.front();
  for (CandidateFit& t : round.fits) {
    const bool open = t.fitted && t.log_evidence > first.log_evidence - kOpen;
    const double before =
        std::exchange(t.paired, open ? paired_evidence(t.scored, first.scored, evidence) : 0.0);
    t.log_evidence += t.paired - before;
  }
}

double cost_of_unknowns(const Hypothesis& hypothesis, double samples, std::size_t runs) {
  const bool waves = hypothesis.model.effects.periodic_disturbance.has_value();
  double free = waves ? static_cast<double>(runs) : 0.0;  // each run has its phase
  for (const Unknown& u : hypothesis.unknowns) free += std::isfinite(u.prior_std) ? 0.0 : 1.0;
  return free * (0.5 * std::log(samples) + kComplexityPenalty);
}

// A number that seems to be another may be the mean of one that varies with the motion; out of step with it,
// that effect scores nothing. The same where an effect is so strong that its typical strength tells nothing:
// a smoother law of the same variable scores in its place. What is brought follows the `count` promising
// ones.
void bring_what_is_resembled(std::vector<Score>& scores, std::size_t& count, Drive drive) {
  constexpr std::array kResembled{
      std::pair{std::string_view("k"), SpringHardening::info.name},
      std::pair{std::string_view("c_s"), QuadraticDamping::info.name},
      std::pair{std::string_view("c_s"), DirectionalDamping::info.name},
      std::pair{SlowUnzipping::info.name, DirectionalDamping::info.name},
      std::pair{VoltagePower::info.name, VoltageThreshold::info.name},
      std::pair{PiecewiseSpring::info.name, SpringHardening::info.name},
      std::pair{PiecewiseSpring::info.name, AsymmetricSpring::info.name},
  };
  for (const auto& [seems, effect] : kResembled) {
    const auto is = [&](std::string_view name) {
      return [=](const Score& score) { return score.candidate.name(drive) == name; };
    };
    const auto end = scores.begin() + static_cast<std::ptrdiff_t>(count);
    const auto varying = std::find_if(end, scores.end(), is(effect));
    if (std::find_if(scores.begin(), end, is(seems)) == end || varying == scores.end() ||
        varying->probes.empty() || varying->probes.front().start.empty())
      continue;
    std::rotate(end, varying, varying + 1);
    ++count;
  }
}

std::string names(const std::vector<Score>& scores, std::size_t count, Drive drive) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i) out += (i ? ", " : "") + scores[i].candidate.name(drive);
  return out;
}

}  // namespace

bool is_effect(const Candidate& candidate, std::string_view name) {
  return candidate.effect != kBaseline && library_effect(candidate.effect).info.name == name;
}

bool is_dry_friction(const Candidate& candidate) {
  return is_effect(candidate, CoulombFriction::info.name) ||
         is_effect(candidate, StribeckFriction::info.name);
}

bool resembles_many(const Candidate& candidate) {
  constexpr std::array kSuch{AsymmetricSpring::info.name, PiecewiseSpring::info.name,
                             DirectionalDamping::info.name, SlowUnzipping::info.name,
                             VoltagePower::info.name};
  return std::ranges::any_of(kSuch, [&](std::string_view name) { return is_effect(candidate, name); });
}

ScoredModel score_model(Hypothesis hypothesis, const Evidence& evidence) {
  ScoredModel out{std::move(hypothesis), {}, 0.0};
  out.residual = residual(out.hypothesis.model, evidence, Part::HeldOut);
  out.square = mean_square(out.residual);
  return out;
}

double held_out_effective_sample_size(const Evidence& evidence) {
  double windows = 0.0;
  for (const EvidenceRun& run : evidence.runs)
    if (run.training_rows < run.rows.size()) windows += static_cast<double>(run.windows.size());
  return windows > 0.0 ? windows : independent_samples(evidence.held_out_seconds);
}

double log_evidence(const ScoredModel& scored, const Evidence& evidence) {
  const double effective_sample_size = held_out_effective_sample_size(evidence);
  const double tolerated = kTolerance * evidence.noise;
  if (!std::isfinite(scored.square)) return -std::numeric_limits<double>::infinity();
  return -0.5 * effective_sample_size * std::log(scored.square + tolerated * tolerated) -
         0.5 * scored.hypothesis.prior_cost() -
         cost_of_unknowns(scored.hypothesis, effective_sample_size, evidence.runs.size());
}

void let_training_decide(Round& round, const Evidence& evidence) {
  double most = -std::numeric_limits<double>::infinity();
  for (const CandidateFit& t : round.fits)
    if (t.fitted) most = std::max(most, t.log_evidence);
  const auto open = [&](const CandidateFit& t) { return t.fitted && t.log_evidence > most - kUndecided; };
  if (std::ranges::count_if(round.fits, open) < 2) return;
  const double samples = independent_samples(evidence.training_seconds),
               tolerated = kTolerance * evidence.noise;
  std::vector<double> lacks(round.fits.size(), 0.0);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < round.fits.size(); ++i) {
    if (!open(round.fits[i])) continue;
    const Hypothesis& one = round.fits[i].scored.hypothesis;
    const double left = mean_square(residual(one.model, evidence, Part::Training));
    lacks[i] = 0.5 * samples * std::log(left + tolerated * tolerated) +
               cost_of_unknowns(one, samples, evidence.runs.size());
    least = std::min(least, lacks[i]);
  }
  for (std::size_t i = 0; i < round.fits.size(); ++i)
    if (open(round.fits[i])) lacks[i] -= least;
  for (std::size_t i = 0; i < round.fits.size(); ++i) round.fits[i].log_evidence -= std::max(0.0, lacks[i]);
}

void rank(Round& round, const ScoredModel& now, const Evidence& evidence) {
  sort_by_evidence(round);
  prefer_told_apart(round, evidence);
  keep_simpler(round, evidence);
  sort_by_evidence(round);
  normalise_probabilities(round);
  mark_indistinguishable(round, now);
}

Round selection_step(const ScoredModel& now, const Evidence& coarse, const Evidence& fine,
                     const RoundName& name, const Progress& progress, const std::stop_token& stop,
                     const Rivals& rivals) {
  std::vector<Candidate> open = open_candidates(now.hypothesis, coarse.tissue);
  if (!rivals.among.empty())
    std::erase_if(open, [&](const Candidate& one) {
      return std::ranges::find(rivals.among, one) == rivals.among.end();
    });
  progress(name.share, fmt::format("{}: score test of {} candidates", name.title, open.size()));
  std::vector<Score> scores = score_candidates(now.hypothesis, coarse, open);
  if (stop.stop_requested()) return {};
  const std::size_t most = std::min(name.number > 1 ? kLaterQuickFits : kQuickFits, scores.size());
  std::size_t promising = 0;
  while (promising < most && scores[promising].share() > kWorthFitting * scores.front().share() &&
         scores[promising].share() > 0.0)
    ++promising;
  bring_what_is_resembled(scores, promising, now.drive());
  Round round;
  for (const Score& score : scores)
    round.fits.push_back(
        {.candidate = score.candidate, .round = name.number, .share = score.share(), .scored = {}});
  progress(0.7 * name.share + 0.3 * name.share_after,
           fmt::format("{}: fitting {}", name.title, names(scores, promising, now.drive())));
  fit_quickly(round.fits, scores, promising, now.hypothesis, coarse, stop);
  if (stop.stop_requested()) return {};
  const auto end = round.fits.begin() + static_cast<std::ptrdiff_t>(promising);
  std::stable_sort(round.fits.begin(), end, by_square);
  progress(0.4 * name.share + 0.6 * name.share_after, fmt::format("{}: fitting the best fully", name.title));
  fit_best_fully(round.fits, promising, rivals.known, coarse, fine);
  for (CandidateFit& t : round.fits)
    t.fitted = t.fitted && !(resembles_many(t.candidate) &&
                             std::sqrt(excess(t.scored.square, fine)) > kHardlyMore * fine.noise);
  std::stable_sort(round.fits.begin(), end, by_square);
  if (promising == 0) return round;
  round.null_evidence = log_evidence(now, fine);
  for (CandidateFit& t : round.fits)
    if (t.fitted) t.log_evidence = log_evidence(t.scored, fine);
  let_training_decide(round, fine);
  rank(round, now, fine);
  return round;
}

}  // namespace biopsy::sim::gap
