#include "sim/gap/select/select.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "sim/gap/fit/fit.hpp"
#include "sim/gap/fit/restart.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/select/compare_candidates.hpp"
#include "sim/gap/select/exchange.hpp"
#include "sim/gap/select/told_apart.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr std::size_t kMostRounds = 5;
constexpr double kNeededEvidence = 10.0;  // odds of 20000 to 1: family-wise false-positive rate < 5 %
constexpr double kWorthTrying = 0.25;     // of the remaining excess square: two equal effects share it,
constexpr double kWorthKeeping = 0.5;     // but the last one must explain most of what was left
constexpr double kMuchLeft = 0.05;        // of the first excess square
constexpr double kOnlyNoise = 0.25;       // an excess below this share of the noise changes no RMSE by 4 %
constexpr double kBelowNoise = 1.0;       // remainder, in noises, that does not justify a second effect
constexpr double kImprecision =
    0.0025;                         // nor a share of the first excess square: an effect's form is its own
constexpr double kAsGood = 1.05;    // ratio of mean squares within which the evidence decides
constexpr double kFarBehind = 9.0;  // ratio of mean squares: a third of the winner's precision
constexpr std::uint64_t kMostWork = 300'000'000;      // steps: most of a minute of a processor
constexpr std::uint64_t kWorkForThird = 200'000'000;  // with two effects found; the rest is for their test
constexpr std::uint64_t kWorkForTests = 400'000'000;
constexpr std::size_t kMostRivals = 4;  // with which an effect is compared again
constexpr int kRefitIterations = 15, kReducedIterations = 8;
constexpr double kReducedConverged = 1e-2;                                           // of the cost
constexpr double kShareBefore = 0.1, kShareOfRounds = 0.75, kShareOfContest = 0.88;  // of the work

// `much_left`: most of the gap is still open, so that the second of two equal effects may follow.
bool is_accepted(const Round& round, const ScoredModel& now, bool much_left, const Evidence& evidence) {
  if (round.fits.empty() || !round.fits.front().fitted) return false;
  const CandidateFit& first = round.fits.front();
  const double needed = much_left ? kWorthTrying : kWorthKeeping;
  const bool paired = excess(now.square, evidence) > std::pow(kBelowNoise * evidence.noise, 2) &&
                      paired_evidence(first.scored, now, evidence) > kNeededEvidence;
  return (first.log_evidence > round.null_evidence + kNeededEvidence || paired) &&
         excess(square_of_both(first, evidence), evidence) <
             (1.0 - needed) * excess(square_of_both(now, round, evidence), evidence);
}

// Of the excess square, by the round's winner.
double reduction(const ScoredModel& from, const Round& round, const Evidence& evidence) {
  const double left = excess(square_of_both(from, round, evidence), evidence);
  return left > 0.0 ? 1.0 - excess(square_of_both(round.fits.front(), evidence), evidence) / left : 0.0;
}

bool leaves_noise(const ScoredModel& now, const Evidence& evidence) {
  return std::sqrt(excess(now.square, evidence)) < kBelowNoise * evidence.noise;
}

// The remainder is small against what was explained: that the effects are not quite of the library's form
// would be taken for a further one.
bool is_imprecision(const ScoredModel& now, const ScoredModel& start, const Evidence& evidence) {
  return std::isfinite(start.square) &&
         excess(now.square, evidence) < kImprecision * excess(start.square, evidence);
}

// The remainder is noise. Before anything is named in the training runs
// too: the held-out ones may not show what is missing.
bool is_closed(const ScoredModel& now, bool named, const Evidence& evidence) {
  if (named) return leaves_noise(now, evidence);
  return is_only_noise(now.square, evidence) &&
         is_only_noise(mean_square(residual(now.hypothesis.model, evidence, Part::Training)), evidence);
}

// The winner of a round that leaves much: fitted again from other shapes and places, before what a poor fit
// leaves is taken for a second effect.
void refit_elsewhere(CandidateFit& first, const Evidence& coarse, const Evidence& fine,
                     const std::function<void()>& say) {
  if (first.candidate.effect == kBaseline || leaves_noise(first.scored, fine) || is_exhausted(fine)) return;
  say();
  Hypothesis other = restarted(first.scored.hypothesis, first.candidate.effect, coarse);
  fit_closely(other, fine, kRefitIterations);
  ScoredModel scored = score_model(std::move(other), fine);
  if (scored.square < first.scored.square) first.scored = std::move(scored);
}

bool is_effect(const SelectedTerm& term, std::string_view name) {
  return term.is_effect() && library_effect(term.candidate.effect).info.name == name;
}

// Coulomb beside Stribeck friction is Stribeck friction: the sum of both has its form. It was found as
// Coulomb friction first where the fit of the other began at the wrong speed.
bool merge_friction(std::vector<SelectedTerm>& selected, std::vector<ScoredModel>& models,
                    const Evidence& fine) {
  const auto find = [&](std::string_view name) {
    return std::ranges::find_if(selected, [&](const SelectedTerm& term) { return is_effect(term, name); });
  };
  const auto simple = find(CoulombFriction::info.name), rich = find(StribeckFriction::info.name);
  if (simple == selected.end() || rich == selected.end()) return false;
  Hypothesis merged = models.back().hypothesis;
  const double force = merged.model.effects.coulomb_friction->force;
  for (Unknown& u : merged.unknowns)
    if (u.effect == rich->candidate.effect &&
        library_effect(u.effect).parameters[u.parameter].role == Role::Strength)
      u.theta = std::min(u.theta_of(u.value() + force), u.high);
  std::erase_if(merged.unknowns, [&](const Unknown& u) { return u.effect == simple->candidate.effect; });
  merged.model.effects.coulomb_friction.reset();
  std::vector<double> thetas;
  for (const Unknown& u : merged.unknowns) thetas.push_back(u.theta);
  merged.set(thetas);
  fit_closely(merged, fine, kRefitIterations);
  rich->reduction = 1.0 - (1.0 - rich->reduction) * (1.0 - simple->reduction);
  models.erase(models.begin() + (simple - selected.begin()) + 1);
  selected.erase(simple);
  models.back() = score_model(std::move(merged), fine);
  return true;
}

// The hypothesis without one of its effects, the rest fitted anew but for the last few per cent.
Hypothesis without(const ScoredModel& best, const Candidate& candidate, const Evidence& coarse) {
  Hypothesis reduced = best.hypothesis;
  std::erase_if(reduced.unknowns, [&](const Unknown& u) { return u.effect == candidate.effect; });
  library_effect(candidate.effect).remove(reduced.model);
  fit(reduced, coarse, kReducedIterations, 1.0, kReducedConverged);
  return reduced;
}

// The candidates that came nearest to it when it was selected.
std::vector<Candidate> near_candidates(const SelectedTerm& term) {
  const auto own = std::ranges::find(term.comparison, term.candidate, &CandidateFit::candidate);
  std::vector<const CandidateFit*> rivals;
  for (const CandidateFit& t : term.comparison)
    if (t.fitted && !(t.candidate == term.candidate) && t.scored.square <= kFarBehind * own->scored.square)
      rivals.push_back(&t);
  std::ranges::stable_sort(rivals, {}, [](const CandidateFit* t) { return t->scored.square; });
  if (rivals.size() > kMostRivals) rivals.resize(kMostRivals);
  std::vector<Candidate> out;
  out.reserve(rivals.size());
  for (const CandidateFit* t : rivals) out.push_back(t->candidate);
  // Where a friction of more numbers is a rival, so is the one that it contains and is when these do not
  // matter.
  const auto is = [](std::string_view name) {
    return [=](const Candidate& candidate) { return is_effect(candidate, name); };
  };
  const auto coulomb =
      std::ranges::find_if(term.comparison, is(CoulombFriction::info.name), &CandidateFit::candidate);
  if (coulomb != term.comparison.end() && !(coulomb->candidate == term.candidate) &&
      std::ranges::none_of(out, is(CoulombFriction::info.name)) &&
      (std::ranges::any_of(out, is(LugreFriction::info.name)) ||
       std::ranges::any_of(out, is(StribeckFriction::info.name))))
    out.push_back(coulomb->candidate);
  return out;
}

// Each effect but the last was selected before the others were in the model: it is compared again with them
// present, against those that came near it.
void reselect_terms(Selection& out, const Evidence& coarse, const Evidence& fine, const Progress& progress,
                    const std::stop_token& stop) {
  for (std::size_t i = 0; i + 1 < out.selected.size(); ++i) {
    SelectedTerm& term = out.selected[i];
    const std::vector<Candidate> near = near_candidates(term);
    if (!term.is_effect() || near.empty()) continue;
    if (fine.work->steps > kWorkForTests) {
      out.cut_short = true;
      return;
    }
    const std::string name = term.candidate.name(out.best.drive());
    const ScoredModel now = score_model(without(out.best, term.candidate, coarse), fine);
    Round again = selection_step(now, coarse, fine,
                                 {.number = static_cast<int>(i) + 1,
                                  .title = fmt::format("again in place of {}", name),
                                  .share = kShareOfContest,
                                  .share_after = kShareOfContest},
                                 progress, stop, {.among = near, .known = out.best.square});
    if (again.fits.empty() || !again.fits.front().fitted) continue;
    CandidateFit own = *std::ranges::find(term.comparison, term.candidate, &CandidateFit::candidate);
    own.scored = out.best;
    own.log_evidence = log_evidence(out.best, fine);
    own.paired = 0.0;
    again.fits.push_back(std::move(own));
    rank(again, now, fine);
    if (!(again.fits.front().candidate == term.candidate) &&
        again.fits.front().scored.square < kAsGood * out.best.square) {
      out.best = again.fits.front().scored;
      term.candidate = again.fits.front().candidate;
    }
    term.comparison = std::move(again.fits);
  }
}

// A second effect may only have made up for a poor fit of the first, and is not needed once that is better.
// The effects come in the order of what they explained: the last is tried first.
void drop_unneeded(Selection& out, const Evidence& coarse, const Evidence& fine) {
  for (std::size_t i = out.selected.size(); i-- > 0;) {
    const auto effects = std::ranges::count_if(out.selected, &SelectedTerm::is_effect);
    if (effects < 2 || !out.selected[i].is_effect()) continue;
    const double left = excess(out.best.square, fine);
    Hypothesis reduced = without(out.best, out.selected[i].candidate, coarse);
    const double imprecision =
        std::isfinite(out.start.square) ? kImprecision * excess(out.start.square, fine) : 0.0;
    const double bearable = std::max({left, std::pow(kBelowNoise * fine.noise, 2), imprecision});
    if (excess(score_model(reduced, fine).square, fine) > kFarBehind * bearable) continue;
    fit_closely(reduced, fine, kRefitIterations);
    ScoredModel less = score_model(std::move(reduced), fine);
    const double more = excess(less.square, fine);
    if (!leaves_noise(less, fine) && !is_imprecision(less, out.start, fine) &&
        left < (1.0 - kWorthKeeping) * more)
      continue;
    out.best = std::move(less);
    out.selected.erase(out.selected.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace

double excess(double square, const Evidence& evidence) {
  return std::max(0.0, square - evidence.noise * evidence.noise);
}

bool is_only_noise(double square, const Evidence& evidence) {
  return std::sqrt(excess(square, evidence)) < kOnlyNoise * evidence.noise;
}

bool is_exhausted(const Evidence& evidence) {
  return evidence.work->steps > kMostWork;
}

Selection select(Hypothesis start, const Evidence& coarse, const Evidence& fine, const Progress& progress,
                 std::size_t most_effects, const std::stop_token& stop) {
  Selection out{.start = score_model(std::move(start), fine), .best = {}, .fits = {}, .selected = {}};
  std::vector<ScoredModel> models{out.start};
  std::size_t effects = 0;
  while (out.selected.size() < kMostRounds && effects < most_effects &&
         !is_closed(models.back(), effects > 0, fine) &&
         !(effects > 0 && is_imprecision(models.back(), out.start, fine)) && !stop.stop_requested()) {
    if (is_exhausted(fine) || (effects > 1 && fine.work->steps > kWorkForThird)) {
      out.cut_short = true;
      break;
    }
    const int number = static_cast<int>(out.selected.size()) + 1;
    // Each further round is half as likely.
    const double begun = kShareBefore + kShareOfRounds * (1.0 - std::pow(0.5, number - 1)),
                 over = kShareBefore + kShareOfRounds * (1.0 - std::pow(0.5, number));
    Round round = selection_step(models.back(), coarse, fine,
                                 {number, fmt::format("round {}", number), begun, over}, progress, stop);
    const bool much_left = excess(models.back().square, fine) > kMuchLeft * excess(out.start.square, fine);
    bool found = is_accepted(round, models.back(), much_left, fine);
    if (!found && effects == 0 && !is_exhausted(fine) && !stop.stop_requested()) {
      progress(over, fmt::format("round {}: training and held-out runs exchanged", number));
      found = judge_by_both(round, models.back(), fine) && is_accepted(round, models.back(), much_left, fine);
      out.by_both = out.by_both || found;
    }
    if (found) {
      refit_elsewhere(round.fits.front(), coarse, fine, [&] {
        progress(over, fmt::format("round {}: {} from other shapes and places", number,
                                   round.fits.front().candidate.name(out.start.drive())));
      });
      round.fits.front().chosen = true;
      out.selected.push_back(
          {round.fits.front().candidate, reduction(models.back(), round, fine), round.fits});
      models.push_back(round.fits.front().scored);
      if (out.selected.back().is_effect()) ++effects;
      if (merge_friction(out.selected, models, fine)) --effects;
    }
    out.fits.insert(out.fits.end(), round.fits.begin(), round.fits.end());
    if (!found) break;
  }
  while (!out.selected.empty() && out.selected.back().reduction < kWorthKeeping) {
    out.selected.pop_back();
    models.pop_back();
  }
  out.best = models.back();
  if (!stop.stop_requested() && !is_exhausted(fine)) drop_unneeded(out, coarse, fine);
  for (CandidateFit& fit : out.fits)
    fit.chosen = fit.chosen && std::ranges::any_of(out.selected, [&](const SelectedTerm& term) {
                   return term.candidate == fit.candidate;
                 });
  if (!stop.stop_requested()) reselect_terms(out, coarse, fine, progress, stop);
  return out;
}

}  // namespace biopsy::sim::gap
