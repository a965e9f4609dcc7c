#include "sim/gap/find_gap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/gap/fit/fit.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/select/compare_candidates.hpp"
#include "sim/gap/select/make_finding.hpp"
#include "sim/gap/select/verdict.hpp"
#include "sim/plant/plant.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr int kIterations = 25;
constexpr double kNotWorse = 1.05;       // held-out mean square
constexpr double kPiece = 0.5;           // s: some times of the stage's own ringing, a few jerks at most
constexpr double kShortPiece = 2.0;      // of the mechanism's own time: a third of its period
constexpr double kFewestReadings = 8.0;  // of a piece

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
ScoredModel polished(const ScoredModel& best, double before, const Evidence& evidence) {
  Hypothesis fitted = best.hypothesis;
  fit(fitted, evidence, kIterations, kNothingMissing);
  ScoredModel judged = judge(std::move(fitted), evidence);
  const bool closes = well_explained(before, judged.square, evidence);
  return closes && judged.square < kNotWorse * best.square ? judged : best;
}

struct Search {
  Evidence evidence;
  ScoredModel as_given;
  Selection selection;
  bool interrupted = false;

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
  progress(0.0, "simulating every run with the model as it is");
  const Hypothesis before = as_written(start, out.evidence);
  out.as_given = judge(before, out.evidence);
  out.selection = {.start = out.as_given, .best = out.as_given, .fits = {}, .selected = {}};
  if (is_only_noise(mean_square(residual(before.model, out.evidence, Part::All)), out.evidence)) return out;
  progress(0.05, "fitting the baseline's numbers within their calibration errors");
  carry_over(start, before);
  fit(start, out.evidence, kIterations);
  out.selection = select(std::move(start), prepare(dataset, model, options.window, Grain::Coarse),
                         out.evidence, progress, most_effects, options.stop);
  out.interrupted = options.stop.stop_requested();
  if (out.interrupted) return out;
  progress(0.9, "the last fit, and standard deviations");
  out.selection.best = polished(out.selection.best, out.as_given.square, out.evidence);
  estimate_uncertainty(out.selection.best.hypothesis, out.evidence);
  return out;
}

// Dry friction is what explains most, by itself or as well as what entered.
bool friction_dominated(const Selection& selection) {
  if (selection.selected.empty()) return false;
  const SelectedTerm& first = selection.selected.front();
  return std::any_of(first.contest.begin(), first.contest.end(), [&](const CandidateFit& t) {
    return is_dry_friction(t.candidate) && (t.candidate == first.candidate || t.indistinguishable);
  });
}

bool is_stribeck(const Selection& selection) {
  if (selection.selected.empty()) return false;
  const Candidate& first = selection.selected.front().candidate;
  return first.effect != kBaseline &&
         library()[static_cast<std::size_t>(first.effect)].info.name == StribeckFriction::info.name;
}

// Short enough for what is missing not to bring the mechanism's ringing out of step with the model's.
double short_piece(const Dataset& dataset, const PlantModel& model) {
  double period = 0.0;
  for (const RecordedRun& run : dataset.runs) period = std::max(period, run.period);
  return std::min(kPiece, std::max(kShortPiece / fastest_rate(model), kFewestReadings * period));
}

Search in_pieces(const Dataset& dataset, const PlantModel& model, const SearchOptions& options, double piece,
                 const Progress& progress) {
  progress(0.9, fmt::format("whole runs leave the gap open: again in pieces of {:.2g} s", piece));
  return search(dataset, model, {.free = options.free, .window = piece, .stop = options.stop}, progress, 1);
}

// The name that pieces gave, with its numbers fitted to whole runs, if it explains those as well.
std::optional<Search> confirmed(const Search& whole, const Search& pieces) {
  if (pieces.verdict() != GapVerdict::Effect || pieces.interrupted) return std::nullopt;
  Search out = whole;
  out.selection = pieces.selection;
  out.selection.start = whole.selection.start;
  Hypothesis& best = out.selection.best.hypothesis;
  fit(best, whole.evidence, kIterations);
  out.selection.best = polished(judge(best, whole.evidence), whole.as_given.square, whole.evidence);
  if (!well_explained(whole.as_given.square, out.selection.best.square, whole.evidence)) return std::nullopt;
  estimate_uncertainty(out.selection.best.hypothesis, whole.evidence);
  return out;
}

}  // namespace

// Where whole runs do not tell, pieces that start from the measured motion are asked as well.
//
// When a plate that sticks and slips breaks away decides all that follows, so no model follows a whole run of
// it, not even the true one: where friction leads and leaves the gap open, pieces are believed if they say
// stick-slip. And what shifts a mechanism's resonance by much puts model and measurement out of step, so that
// no small change of anything helps: there pieces find the name, and whole runs judge it.
FoundGap find_gap(const Dataset& dataset, const PlantModel& model, const SearchOptions& options,
                  const Progress& progress) {
  Search found = search(dataset, model, options, progress);
  std::string warning;
  const bool whole = !options.window && !options.stop.stop_requested();
  if (whole && found.leaves_open() && friction_dominated(found.selection)) {
    Search again = in_pieces(dataset, model, options, kPiece, progress);
    if (!again.interrupted && is_stribeck(again.selection)) {
      found = std::move(again);
      warning = fmt::format(
          "All figures are of pieces of {} s that each start from the measured motion: plate A sticks and "
          "slips, and when it breaks away decides all that follows.",
          kPiece);
    }
  } else if (whole && found.verdict() == GapVerdict::Unexplained && model.baseline.drive == Drive::Force) {
    const double piece = short_piece(dataset, found.as_given.hypothesis.model);
    std::optional<Search> named = confirmed(found, in_pieces(dataset, model, options, piece, progress));
    if (named) {
      found = std::move(*named);
      warning = fmt::format(
          "The candidates were compared in pieces of {:.2g} s that each start from the measured motion; the "
          "numbers, and the RMSE before and after, are of whole runs.",
          piece);
    }
  }
  FoundGap out = make_finding(model, found.as_given, found.selection, found.evidence);
  if (!warning.empty()) out.finding.warnings.push_back(warning);
  out.finding.interrupted = options.stop.stop_requested();
  if (out.finding.interrupted)
    out.finding.warnings.insert(
        out.finding.warnings.begin(),
        fmt::format(
            "Interrupted: the verdict is that of {} of the search. There may be more to find, numbers "
            "have no standard deviation, and unexplained means not explained yet.",
            out.finding.effects.empty() && out.finding.parameters_changed.empty()
                ? "the beginning"
                : "the rounds that were finished"));
  return out;
}

}  // namespace biopsy::sim::gap
