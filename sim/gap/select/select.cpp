#include "sim/gap/select/select.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/gap/fit/fit.hpp"
#include "sim/gap/select/compare_candidates.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr std::size_t kMostRounds = 5;
constexpr double kNeededEvidence = 10.0;  // odds of 20000 to 1: the whole library gets its say well under 5 %
constexpr double kWorthTrying = 0.25;     // of the excess square that is left: two equals share it,
constexpr double kWorthKeeping = 0.5;     // but the last to enter must close most of what was left
constexpr double kMuchLeft = 0.05;        // of the first excess square
constexpr double kOnlyNoise = 0.25;       // excess below this share of the noise changes no RMSE by 4 %
constexpr double kBelowNoise = 1.0;       // what is left of a gap that has a name already, in noises
constexpr double kAsGood = 1.05;          // mean square: then the evidence decides who has the place
constexpr double kFarBehind = 9.0;        // mean square: a third of the winner's precision
constexpr int kRefitIterations = 15;
constexpr double kShareBefore = 0.1, kShareOfRounds = 0.75, kShareOfContest = 0.88;  // of the work

// `much_left`: the gap is still wide open, so that a second of two equals may be about to follow.
bool convinces(const Round& round, const ScoredModel& now, bool much_left, const Evidence& evidence) {
  if (round.fits.empty() || !round.fits.front().fitted) return false;
  const CandidateFit& first = round.fits.front();
  const double needed = much_left ? kWorthTrying : kWorthKeeping;
  return first.log_evidence > round.nothing + kNeededEvidence &&
         excess(first.judged.square, evidence) < (1.0 - needed) * excess(now.square, evidence);
}

double reduction(const ScoredModel& from, const ScoredModel& to, const Evidence& evidence) {
  const double left = excess(from.square, evidence);
  return left > 0.0 ? 1.0 - excess(to.square, evidence) / left : 0.0;
}

// Nothing left that could be told from the noise, or too little to be asked for a second name.
bool is_closed(const ScoredModel& now, bool named, const Evidence& evidence) {
  if (named && std::sqrt(excess(now.square, evidence)) < kBelowNoise * evidence.noise) return true;
  return is_only_noise(now.square, evidence);
}

// The hypothesis without one of its effects, the rest fitted anew.
ScoredModel without(const ScoredModel& best, const Candidate& candidate, const Evidence& fine) {
  Hypothesis reduced = best.hypothesis;
  std::erase_if(reduced.unknowns, [&](const Unknown& u) { return u.effect == candidate.effect; });
  library()[static_cast<std::size_t>(candidate.effect)].remove(reduced.model);
  fit(reduced, fine, kRefitIterations);
  return judge(std::move(reduced), fine);
}

// Nothing came near it when it entered: what entered later did not decide that.
bool has_clear_margin(const SelectedTerm& term) {
  double own = 0.0, next = std::numeric_limits<double>::infinity();
  for (const CandidateFit& t : term.contest) {
    if (t.candidate == term.candidate)
      own = t.judged.square;
    else if (t.fitted)
      next = std::min(next, t.judged.square);
  }
  return next > kFarBehind * own;
}

// Each effect but the last to enter was chosen when the others were not there yet: it must win its place
// again, unless it had it without a rival.
void contest_places(Selection& out, const Evidence& coarse, const Evidence& fine, const Progress& progress,
                    const std::stop_token& stop) {
  for (std::size_t i = 0; i + 1 < out.selected.size(); ++i) {
    SelectedTerm& term = out.selected[i];
    if (!term.is_effect() || has_clear_margin(term)) continue;
    const std::string name = term.candidate.name(out.best.drive());
    Round again = selection_step(without(out.best, term.candidate, fine), coarse, fine,
                                 {.number = static_cast<int>(i) + 1,
                                  .title = fmt::format("again for {}'s place", name),
                                  .share = kShareOfContest,
                                  .share_after = kShareOfContest},
                                 progress, stop);
    if (again.fits.empty() || !again.fits.front().fitted) continue;
    if (again.fits.front().judged.square < kAsGood * out.best.square) {
      out.best = again.fits.front().judged;
      term.candidate = again.fits.front().candidate;
    }
    term.contest = std::move(again.fits);
  }
}

}  // namespace

double excess(double square, const Evidence& evidence) {
  return std::max(0.0, square - evidence.noise * evidence.noise);
}

bool is_only_noise(double square, const Evidence& evidence) {
  return std::sqrt(excess(square, evidence)) < kOnlyNoise * evidence.noise;
}

Selection select(Hypothesis start, const Evidence& coarse, const Evidence& fine, const Progress& progress,
                 std::size_t most_effects, const std::stop_token& stop) {
  Selection out{.start = judge(std::move(start), fine), .best = {}, .fits = {}, .selected = {}};
  std::vector<ScoredModel> stands{out.start};
  std::size_t effects = 0;
  while (out.selected.size() < kMostRounds && effects < most_effects &&
         !is_closed(stands.back(), effects > 0, fine) && !stop.stop_requested()) {
    const int number = static_cast<int>(out.selected.size()) + 1;
    // Each further round is half as likely.
    const double begun = kShareBefore + kShareOfRounds * (1.0 - std::pow(0.5, number - 1)),
                 over = kShareBefore + kShareOfRounds * (1.0 - std::pow(0.5, number));
    Round round = selection_step(stands.back(), coarse, fine,
                                 {number, fmt::format("round {}", number), begun, over}, progress, stop);
    const bool much_left = excess(stands.back().square, fine) > kMuchLeft * excess(out.start.square, fine);
    const bool found = convinces(round, stands.back(), much_left, fine);
    if (found) {
      round.fits.front().chosen = true;
      out.selected.push_back({round.fits.front().candidate,
                              reduction(stands.back(), round.fits.front().judged, fine), round.fits});
      stands.push_back(round.fits.front().judged);
      if (out.selected.back().is_effect()) ++effects;
    }
    out.fits.insert(out.fits.end(), round.fits.begin(), round.fits.end());
    if (!found) break;
  }
  while (!out.selected.empty() && out.selected.back().reduction < kWorthKeeping) {
    out.selected.pop_back();
    stands.pop_back();
  }
  for (CandidateFit& trial : out.fits)
    if (static_cast<std::size_t>(trial.round) > out.selected.size()) trial.chosen = false;
  out.best = stands.back();
  if (!stop.stop_requested()) contest_places(out, coarse, fine, progress, stop);
  return out;
}

}  // namespace biopsy::sim::gap
