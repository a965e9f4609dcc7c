#include "sim/gap/find_gap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "sim/gap/examine/examine.hpp"
#include "sim/gap/fit/fit.hpp"
#include "sim/gap/millimetres.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/residual/straw_men.hpp"
#include "sim/gap/select/choose.hpp"
#include "sim/gap/select/compare_candidates.hpp"
#include "sim/gap/select/held_out.hpp"
#include "sim/gap/select/make_finding.hpp"
#include "sim/gap/select/objections.hpp"
#include "sim/gap/select/verdict.hpp"
#include "sim/gap/term/propose_term.hpp"
#include "sim/plant/plant.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr int kIterations = 25;
constexpr double kNotWorse = 1.05;      // held-out mean square
constexpr double kWindow = 0.5;         // s: a few periods of the stage's ringing, a few stick-slip jumps
constexpr double kMuchLeft = 1.0;       // noises that a name leaves: beyond, it competes with an equation
constexpr double kEquationWins = 0.25;  // of the excess square that a name leaves

// The given model, fitted in the parameters that were declared free.
Hypothesis fit_free_parameters(const Hypothesis& start, const Evidence& evidence) {
  Hypothesis out = start;
  std::erase_if(out.unknowns, [](const Unknown& u) { return std::isfinite(u.prior_std); });
  fit_closely(out, evidence, kIterations);
  return out;
}

// Numbers of a mechanism that are said to be unknown are not held against the file: what looks like another
// unit or clock of all runs is examined again by the numbers that fit best.
std::vector<DataRemark> examined(const Dataset& dataset, const PlantModel& model, const SearchOptions& told) {
  std::vector<DataRemark> remarks = examine(dataset, model, noise_of(dataset));
  const bool may_be_the_model = !remarks.empty() && remarks.front().blocks &&
                                remarks.front().cause == "unit" &&
                                remarks.front().runs.size() == dataset.runs.size();
  if (!may_be_the_model || told.free.empty() || model.baseline.drive != Drive::Force) return remarks;
  const Evidence evidence =
      prepare(dataset, model, told.window ? told.window : window_of_drift(dataset, model), Sampling::Coarse);
  const Hypothesis fitted = fit_free_parameters(baseline_hypothesis(model, told.free), evidence);
  std::vector<DataRemark> again = examine(dataset, fitted.model, noise_of(dataset));
  return again.empty() || !again.front().blocks ? again : remarks;
}

// Values of `fitted` copied to a hypothesis with more unknowns.
void copy_fitted(Hypothesis& to, const Hypothesis& fitted) {
  std::vector<double> thetas;
  for (Unknown& u : to.unknowns) {
    for (const Unknown& known : fitted.unknowns)
      if (known.effect == u.effect && known.parameter == u.parameter) u.theta = known.theta;
    thetas.push_back(u.theta);
  }
  to.set(thetas);
}

// Refit with the readings outweighing the priors. Kept only where the gap is then closed (otherwise the
// parameters compensate for what is missing) and the held-out runs are not predicted worse.
ScoredModel refined(const ScoredModel& best, double before, const Evidence& evidence) {
  Hypothesis fitted = best.hypothesis;
  fit(fitted, evidence, kIterations, kTrustReadings);
  ScoredModel scored = score_model(std::move(fitted), evidence);
  const bool closes = well_explained(before, scored.square, evidence);
  return closes && scored.square < kNotWorse * best.square ? scored : best;
}

struct Search {
  Evidence evidence, coarse;
  ScoredModel as_given;
  Selection selection;
  bool interrupted = false;

  GapVerdict verdict() const { return gap::verdict(as_given, selection, evidence); }
  bool gap_remains() const {
    return !well_explained(as_given.square, selection.best.square, evidence) &&
           verdict() != GapVerdict::NoGap;
  }
};

Search search(const Dataset& dataset, const PlantModel& model, const SearchOptions& options,
              const Progress& progress, std::shared_ptr<Work> work, std::size_t most_effects = kMostEffects) {
  Search out{.evidence = prepare(dataset, model, options.window, Sampling::Fine),
             .coarse = prepare(dataset, model, options.window, Sampling::Coarse),
             .as_given = {},
             .selection = {}};
  out.coarse.work = out.evidence.work = std::move(work);
  Hypothesis start = baseline_hypothesis(model, options.free);
  const HeldOut held_out = choose_held_out(start, out.coarse);
  hold_out(out.evidence, held_out);
  hold_out(out.coarse, held_out);
  progress(0.0, "simulating every run with the given model");
  const Hypothesis before = options.free_chosen ? Hypothesis{.model = model, .unknowns = {}}
                                                : fit_free_parameters(start, out.evidence);
  out.as_given = score_model(before, out.evidence);
  out.selection = {.start = out.as_given, .best = out.as_given, .fits = {}, .selected = {}};
  if (is_only_noise(mean_square(residual(before.model, out.evidence, Part::All)), out.evidence)) return out;
  progress(0.05, "fitting the baseline parameters within their calibration errors");
  copy_fitted(start, before);
  fit_closely(start, out.evidence, kIterations);
  out.selection = select(std::move(start), out.coarse, out.evidence, progress, most_effects, options.stop);
  out.interrupted = options.stop.stop_requested();
  if (out.interrupted) return out;
  progress(0.9, "final fit and standard deviations");
  out.selection.best = refined(out.selection.best, out.as_given.square, out.evidence);
  estimate_uncertainty(out.selection.best.hypothesis, out.evidence);
  if (out.verdict() == GapVerdict::Effect) {
    out.selection.objections = objections(out.selection, out.coarse, out.evidence);
  } else if (out.verdict() == GapVerdict::Parameter) {
    widen_untold(out.selection.best, out.evidence);
    out.selection.objections = objections_to_numbers(out.selection, out.coarse);
  }
  return out;
}

// Dry friction explains most of the gap, or as much as the selected effect.
bool friction_dominated(const Selection& selection) {
  if (selection.selected.empty()) return false;
  const SelectedTerm& first = selection.selected.front();
  return std::any_of(first.comparison.begin(), first.comparison.end(), [&](const CandidateFit& t) {
    const bool dry = is_dry_friction(t.candidate) || is_effect(t.candidate, LoadDependentFriction::info.name);
    return dry && (t.candidate == first.candidate || t.indistinguishable);
  });
}

bool sticks_and_slips(const Selection& selection) {
  if (selection.selected.empty()) return false;
  const Candidate& first = selection.selected.front().candidate;
  return is_effect(first, StribeckFriction::info.name) || is_effect(first, LugreFriction::info.name);
}

Search search_in_windows(const Dataset& dataset, const PlantModel& model, const SearchOptions& options,
                         double window, const Progress& progress, const std::shared_ptr<Work>& work) {
  progress(0.9, fmt::format("whole runs leave the gap open: repeating with windows of {:.2g} s", window));
  return search(dataset, model,
                {.free = options.free,
                 .window = window,
                 .choose = options.choose,
                 .free_chosen = options.free_chosen,
                 .stop = options.stop},
                progress, work, 1);
}

// The effect found in windows with its parameters fitted to whole runs, if it explains those as well.
std::optional<Search> confirmed_on_whole_runs(const Search& whole, const Search& windows) {
  const std::vector<SelectedTerm>& selected = windows.selection.selected;
  if (windows.interrupted || selected.empty() || !selected.front().is_effect()) return std::nullopt;
  Search out = whole;
  out.selection = windows.selection;
  out.selection.objections.clear();  // were of windows, which a noisy start blurs
  out.selection.start = whole.selection.start;
  Hypothesis& best = out.selection.best.hypothesis;
  fit_closely(best, whole.evidence, kIterations);
  out.selection.best = refined(score_model(best, whole.evidence), whole.as_given.square, whole.evidence);
  if (!well_explained(whole.as_given.square, out.selection.best.square, whole.evidence)) return std::nullopt;
  estimate_uncertainty(out.selection.best.hypothesis, whole.evidence);
  out.selection.objections = objections(out.selection, whole.coarse, whole.evidence);
  return out;
}

// A name after which more than noise is left: an equation may say better what is missing.
bool leaves_much(const Search& found) {
  return found.verdict() == GapVerdict::Effect &&
         std::sqrt(excess(found.selection.best.square, found.evidence)) > kMuchLeft * found.evidence.noise;
}

// What no effect explains as an equation, where there is one. Where a name leaves much more than the
// equation, it is not the name: the effect only resembles the law.
std::optional<TermProposal> proposal_for(Search& found, const Progress& progress,
                                         const std::stop_token& stop) {
  const bool named = leaves_much(found);
  if (found.interrupted || !(named || found.verdict() == GapVerdict::Unexplained)) return std::nullopt;
  progress(0.95, named ? "the name leaves much: looking for an equation that leaves less"
                       : "no effect fits: looking for an equation");
  std::optional<TermProposal> proposal =
      propose_term(found.as_given, found.selection.start, found.coarse, found.evidence, stop);
  if (!named || !proposal) return proposal;
  const double left = found.selection.best.square, by_equation = proposal->scored.square;
  if (excess(by_equation, found.evidence) > kEquationWins * excess(left, found.evidence)) return std::nullopt;
  found.selection.objections.push_back(
      fmt::format("an equation leaves far less ({:.3g} mm) than it does ({:.3g} mm)",
                  std::sqrt(by_equation) * kMm, std::sqrt(left) * kMm));
  return proposal;
}

// The finding where the recording itself is wrong: nothing was fitted.
FoundGap not_searched(const Dataset& dataset, const PlantModel& model, std::vector<DataRemark> remarks) {
  const Evidence evidence = prepare(dataset, model, {}, Sampling::Coarse);
  const ScoredModel given = score_model({.model = model, .unknowns = {}}, evidence);
  const Selection nothing{.start = given, .best = given, .fits = {}, .selected = {}};
  FoundGap out = make_finding(model, given, nothing, evidence);
  out.finding.verdict = GapVerdict::Unexplained;
  out.model = model;
  out.finding.data = std::move(remarks);
  return out;
}

}  // namespace

// Where whole runs leave the gap open, windows that start from the measured motion are tried.
//
// With stick-slip the instant of breakaway decides all that follows, so that even the true model does not
// follow a whole run: where dry friction explains most and the gap stays open, the windows' result is taken
// if it is Stribeck or LuGre friction. An effect that shifts a mechanism's resonance puts model and
// measurement out of phase, so that the cost has no useful gradient: windows then find the effect and whole
// runs confirm it.
FoundGap find_gap(const Dataset& dataset, const PlantModel& model, const SearchOptions& told,
                  const Progress& progress) {
  progress(0.0, "examining the recording");
  std::vector<DataRemark> remarks = examined(dataset, model, told);
  if (!remarks.empty() && remarks.front().blocks) return not_searched(dataset, model, std::move(remarks));
  SearchOptions options = told;
  const bool chosen = told.choose && told.free.empty() && !told.window;
  Choice choice;
  if (chosen) {
    choice = choose(dataset, model);
    options.free = choice.free;
    options.window = choice.window;
    options.free_chosen = !choice.free.empty();
  }
  Search found = search(dataset, model, options, progress, std::make_shared<Work>());
  std::string warning;
  const bool exhausted = is_exhausted(found.evidence);
  const bool whole = !options.window && !options.stop.stop_requested() && !exhausted;
  if (whole && found.gap_remains() && friction_dominated(found.selection)) {
    Search again = search_in_windows(dataset, model, options, kWindow, progress, found.evidence.work);
    if (!again.interrupted && sticks_and_slips(again.selection)) {
      found = std::move(again);
      warning = fmt::format(
          "All figures are of windows of {} s that start from the measured motion: plate A sticks and slips, "
          "and the instant of breakaway decides all that follows.",
          kWindow);
    }
  }
  if (whole && warning.empty() && found.verdict() == GapVerdict::Unexplained &&
      model.baseline.drive == Drive::Force && !is_exhausted(found.evidence)) {
    const double window = short_window(dataset, found.as_given.hypothesis.model);
    std::optional<Search> named = confirmed_on_whole_runs(
        found, search_in_windows(dataset, model, options, window, progress, found.evidence.work));
    if (named) {
      found = std::move(*named);
      warning = fmt::format(
          "The candidates were compared in windows of {:.2g} s that start from the measured motion; the "
          "parameters and the RMSE before and after are of whole runs.",
          window);
    }
  }
  const std::optional<TermProposal> proposal = proposal_for(found, progress, options.stop);
  FoundGap out = make_finding(model, found.as_given, found.selection, found.evidence);
  if (proposal) {
    out.finding.proposed = proposal->description;
    set_proposed_model(out, proposal->scored.hypothesis, found.evidence);
  }
  if (!options.window) out.finding.straw_men = straw_men(dataset, found.evidence);
  if (!warning.empty()) out.finding.warnings.push_back(warning);
  if (found.selection.cut_short || (exhausted && out.finding.verdict == GapVerdict::Unexplained))
    out.finding.warnings.emplace_back(
        "The search ended at its limit of simulated steps: fewer combinations of effects were tried than for "
        "a shorter or a softer recording. Give shorter runs, or parameters nearer to the truth, to have more "
        "tried.");
  if (found.coarse.searched < 1.0)
    out.finding.warnings.push_back(fmt::format(
        "Candidates were searched on the first {:.0f} % of each run; the figures are of the first "
        "{:.0f} %.",
        100.0 * found.coarse.searched, 100.0 * found.evidence.searched));
  out.finding.comparison = {.free = options.free,
                            .window = options.window.value_or(0.0),
                            .chosen = chosen,
                            .reason = choice.reason,
                            .tissue = found.evidence.tissue,
                            .tissue_given = dataset.tissue.has_value()};
  out.finding.data = std::move(remarks);
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
