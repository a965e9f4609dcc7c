#include "sim/gap/find_gap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/gap/conclude.hpp"
#include "sim/gap/contest.hpp"
#include "sim/gap/fit.hpp"
#include "sim/gap/predict.hpp"
#include "sim/gap/verdict.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr int kIterations = 25;
constexpr double kNotWorse = 1.05;  // held-out mean square
constexpr double kPiece = 0.5;      // s: some times of the stage's own ringing, a few jerks at most

// The model as it was given, but for the numbers that were said to be unknown.
Hypothesis as_written(const Hypothesis& start, const Evidence& evidence) {
  Hypothesis out = start;
  std::erase_if(out.unknowns, [](const Unknown& u) { return std::isfinite(u.prior_std); });
  fit(out, evidence, kIterations);
  return out;
}

// The unknowns of `fitted` carried over to the hypothesis that has more of them.
void carry_over(Hypothesis& to, const Hypothesis& fitted) {
  std::vector<double> thetas;
  for (Unknown& u : to.unknowns) {
    for (const Unknown& known : fitted.unknowns)
      if (known.effect == u.effect && known.parameter == u.parameter) u.theta = known.theta;
    thetas.push_back(u.theta);
  }
  to.settle(thetas);
}

// The numbers as the readings alone have them, where that closes the gap: while something is still missing,
// they would only bend to make up for it. And unless other runs are predicted worse so.
Judged polished(const Judged& best, double before, const Evidence& evidence) {
  Hypothesis fitted = best.hypothesis;
  fit(fitted, evidence, kIterations, kNothingMissing);
  Judged judged = judge(std::move(fitted), evidence);
  const bool closes = well_explained(before, judged.square, evidence);
  return closes && judged.square < kNotWorse * best.square ? judged : best;
}

struct Search {
  Evidence evidence;
  Judged as_given;
  Selection selection;

  GapVerdict verdict() const { return gap::verdict(as_given, selection, evidence); }
  bool leaves_open() const {
    return !well_explained(as_given.square, selection.best.square, evidence) &&
           verdict() != GapVerdict::NoGap;
  }
};

Search search(const Dataset& dataset, const PlantModel& model, const SearchOptions& options,
              const Progress& progress, std::size_t most_effects = kMostEffects) {
  Search out{
      .evidence = prepare(dataset, model, options.window, Grain::Fine), .as_given = {}, .selection = {}};
  Hypothesis start = baseline_hypothesis(model, options.free);
  progress("simulating every run with the model as it is");
  const Hypothesis before = as_written(start, out.evidence);
  out.as_given = judge(before, out.evidence);
  out.selection = {.start = out.as_given, .best = out.as_given, .trials = {}, .entrants = {}};
  if (is_only_noise(mean_square(residual(before.model, out.evidence, Part::All)), out.evidence)) return out;
  progress("fitting the baseline's numbers within their calibration errors");
  carry_over(start, before);
  fit(start, out.evidence, kIterations);
  out.selection = select(std::move(start), prepare(dataset, model, options.window, Grain::Coarse),
                         out.evidence, progress, most_effects);
  progress("the last fit, and standard deviations");
  out.selection.best = polished(out.selection.best, out.as_given.square, out.evidence);
  estimate_uncertainty(out.selection.best.hypothesis, out.evidence);
  return out;
}

// Dry friction is what explains most, by itself or as well as what entered.
bool rubs(const Selection& selection) {
  if (selection.entrants.empty()) return false;
  const Entrant& first = selection.entrants.front();
  return std::any_of(first.contest.begin(), first.contest.end(), [&](const Trial& t) {
    return is_dry_friction(t.candidate) && (t.candidate == first.candidate || t.twin);
  });
}

bool is_stribeck(const Selection& selection) {
  if (selection.entrants.empty()) return false;
  const Candidate& first = selection.entrants.front().candidate;
  return first.effect != kBaseline &&
         library()[static_cast<std::size_t>(first.effect)].info.name == StribeckFriction::info.name;
}

}  // namespace

// When a plate that sticks and slips breaks away decides all that follows, so no model follows a whole run of
// it, not even the true one. Where friction leads and leaves the gap open, pieces that start from the
// measured motion are asked as well, and believed if they say stick-slip.
FoundGap find_gap(const Dataset& dataset, const PlantModel& model, const SearchOptions& options,
                  const Progress& progress) {
  Search found = search(dataset, model, options, progress);
  bool in_pieces = false;
  if (!options.window && found.leaves_open() && rubs(found.selection)) {
    progress(fmt::format("friction leaves the gap open: again in pieces of {} s", kPiece));
    Search again = search(dataset, model, {.free = options.free, .window = kPiece}, progress, 1);
    in_pieces = is_stribeck(again.selection);
    if (in_pieces) found = std::move(again);
  }
  FoundGap out = conclude(model, found.as_given, found.selection, found.evidence);
  if (in_pieces)
    out.finding.warnings.push_back(fmt::format(
        "All figures are of pieces of {} s that each start from the measured motion: plate A sticks and "
        "slips, and when it breaks away decides all that follows.",
        kPiece));
  return out;
}

}  // namespace biopsy::sim::gap
