#include "sim/gap/select/make_finding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "sim/gap/millimetres.hpp"
#include "sim/gap/residual/localize_residual.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/residual/residual_shape.hpp"
#include "sim/gap/residual/run_fit.hpp"
#include "sim/gap/residual/trace.hpp"
#include "sim/gap/select/next_experiment.hpp"
#include "sim/gap/select/objections.hpp"
#include "sim/gap/select/verdict.hpp"
#include "sim/term/term_text.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMovedStds = 3.0;      // a calibration error is reported where it is significant
constexpr double kMovedShare = 0.005;   // and relevant
constexpr double kRounding = 0.1;       // of a standard deviation: the last digit written
constexpr double kWorthNaming = 0.005;  // probability
constexpr double kMostlyClosed = 0.5;   // share of the gap, by small errors of calibration

std::string parameter_name(const Unknown& u, Drive drive) {
  if (u.effect == kBaseline) return std::string(uncertain_baseline(drive)[u.parameter].name);
  const LibraryEffect& effect = library_effect(u.effect);
  return fmt::format("{}.{}", effect.info.name, effect.parameters[u.parameter].name);
}

double si_per_unit(const Unknown& u) {
  return u.effect < 0 ? 1.0 : library_effect(u.effect).parameters[u.parameter].si_per_unit;
}

double value_std(const Unknown& u) {  // in the unit of files
  return u.value_std() / si_per_unit(u);
}

// Digits far below the standard deviation are not significant.
double rounded_to(double value, double step) {
  if (value == 0.0 || !std::isfinite(step) || step <= 0.0) return value;
  const double digits = std::floor(std::log10(std::abs(value))) - std::floor(std::log10(step));
  return std::stod(fmt::format("{:.{}e}", value, static_cast<int>(std::clamp(digits, 0.0, 15.0))));
}

Hypothesis rounded(Hypothesis hypothesis) {
  std::vector<double> thetas;
  for (const Unknown& u : hypothesis.unknowns) {
    const double value = rounded_to(u.value() / si_per_unit(u), kRounding * value_std(u)) * si_per_unit(u);
    const double theta = u.theta_of(value);
    thetas.push_back(std::isfinite(theta) && theta >= u.low && theta <= u.high ? theta : u.theta);
  }
  hypothesis.set(thetas);
  return hypothesis;
}

// Circular mean and standard deviation of the runs' phases, deg: a model file holds a single phase.
GapEstimate common_phase(const PlantModel& model, const Evidence& evidence) {
  std::complex<double> sum = 0.0;
  for (const EvidenceRun& run : evidence.runs)
    sum +=
        std::polar(1.0, in_step(model, evidence, run, run.rows.size()).effects.periodic_disturbance->phase);
  const double agreement = std::abs(sum) / static_cast<double>(evidence.runs.size());
  const double scatter = std::sqrt(-2.0 * std::log(std::clamp(agreement, 1e-3, 1.0)));
  return {"phase_deg", std::round(std::arg(sum) * kDegrees), scatter * kDegrees};
}

FoundEffect describe(const SelectedTerm& term, const Hypothesis& best) {
  const LibraryEffect& effect = library_effect(term.candidate.effect);
  FoundEffect out;
  out.name = effect.info.name;
  out.sentence = effect.info.sentence;
  out.share_explained = term.reduction;
  for (const Unknown& u : best.unknowns)
    if (u.effect == term.candidate.effect)
      out.parameters.push_back(
          {std::string(effect.parameters[u.parameter].name), u.value() / si_per_unit(u), value_std(u)});
  for (const CandidateFit& t : term.comparison) {
    if (t.candidate == term.candidate)
      out.probability = t.probability;
    else if (t.fitted && t.probability >= kWorthNaming)
      out.confused_with.push_back({t.candidate.name(best.model.baseline.drive), t.probability});
  }
  return out;
}

// Dry friction and a smaller constant force are the equation of friction that differs by direction.
void say_friction_by_direction(std::vector<FoundEffect>& found, const Effects& effects) {
  if (!effects.coulomb_friction || !effects.external_force) return;
  const double friction = effects.coulomb_friction->force, force = effects.external_force->force;
  if (std::abs(force) >= friction) return;
  for (FoundEffect& effect : found)
    if (effect.name == ExternalForce::info.name)
      effect.sentence += fmt::format(
          " With the Coulomb friction it is the same as dry friction of {:.3g} N while plate A rises and "
          "{:.3g} N while it falls.",
          friction + force, friction - force);
}

double given_value(const PlantModel& given, const Unknown& u) {  // SI
  if (u.effect != kBaseline) return library_effect(u.effect).get(given, u.parameter);
  return given.baseline.*(uncertain_baseline(given.baseline.drive)[u.parameter].member);
}

void add_changed_parameters(FoundGap& found, const PlantModel& given, const Hypothesis& best) {
  const Drive drive = given.baseline.drive;
  for (const Unknown& u : best.unknowns) {
    found.changed.push_back({parameter_name(u, drive), value_std(u)});
    const bool new_effect = u.effect != kBaseline && !library_effect(u.effect).present(given);
    if (new_effect) continue;
    const double before = given_value(given, u) / si_per_unit(u), after = u.value() / si_per_unit(u);
    const double moved = std::abs(after - before);
    const bool free = !std::isfinite(u.prior_std);
    if (free || (moved > kMovedStds * value_std(u) && moved > kMovedShare * std::abs(before)))
      found.finding.parameters_changed.push_back({parameter_name(u, drive), before, after, value_std(u)});
  }
  std::stable_sort(found.finding.parameters_changed.begin(), found.finding.parameters_changed.end(),
                   [](const ChangedParameter& a, const ChangedParameter& b) {
                     return std::abs(a.after / a.before - 1.0) > std::abs(b.after / b.before - 1.0);
                   });
}

std::vector<GapCandidate> candidates_of(const Selection& selection, Drive drive) {
  std::vector<GapCandidate> out;
  for (const CandidateFit& t : selection.fits) {
    GapCandidate c;
    c.name = t.candidate.name(drive);
    c.kind = t.candidate.effect == kBaseline ? CandidateKind::Parameter : CandidateKind::Effect;
    c.round = t.round;
    c.score = t.share;
    c.fitted = t.fitted;
    if (t.fitted || !t.scored.residual.empty()) c.held_out_rmse = std::sqrt(t.scored.square) * kMm;
    c.probability = t.probability;
    c.chosen = t.chosen;
    out.push_back(c);
  }
  return out;
}

// The winner and the next best effect.
std::vector<FoundGap::Rival> rivals_of(const Selection& selection) {
  std::vector<FoundGap::Rival> out;
  if (selection.selected.empty()) return out;
  for (const CandidateFit& t : selection.selected.front().comparison) {
    if (!t.fitted || !std::isfinite(t.scored.square) || out.size() == 2) continue;
    if (!out.empty() && t.candidate.effect == kBaseline) continue;
    const PlantModel& model = t.scored.hypothesis.model;
    out.push_back({t.candidate.name(model.baseline.drive), model});
  }
  return out.size() < 2 ? std::vector<FoundGap::Rival>{} : out;
}

NextExperiment experiment_between(const std::vector<FoundGap::Rival>& rivals, const Evidence& evidence) {
  if (rivals.empty()) return {};
  std::vector<PlantModel> models;
  std::vector<std::string> names;
  for (const FoundGap::Rival& rival : rivals) models.push_back(rival.model), names.push_back(rival.name);
  return next_experiment(models, names, evidence.noise, evidence.u_max,
                         {.x_low = evidence.x_low, .x_high = evidence.x_high, .input = evidence.u_max});
}

// Without noise the supervisor would take a simulated laser for a frozen one.
void add_sensor_noise(PlantModel& model, std::vector<FoundGap::Source>& changed, double noise) {
  const auto parameter = SensorNoise::parameters()[0];
  // A coarse reading of a large motion may have more than the parameter's range.
  const double um = std::clamp(std::round(noise * 1e9) * 1e-3, 1e-3, parameter.high * 1e3);
  model.effects.sensor_noise = SensorNoise{um * 1e-6};
  changed.push_back({fmt::format("{}.{}", SensorNoise::info.name, parameter.name),
                     std::numeric_limits<double>::quiet_NaN()});
}

void name_runs(GapFinding& f, const Evidence& evidence) {
  for (const EvidenceRun& run : evidence.runs) {
    if (run.training_rows > 0) f.training_runs.push_back(run.name);
    if (run.training_rows < run.rows.size())
      f.held_out_runs.push_back(run.training_rows > 0 ? run.name + " (last third)" : run.name);
  }
}

RejectedName rejected_name(const ScoredModel& before, const Selection& selection, const Evidence& evidence) {
  RejectedName out;
  for (const SelectedTerm& term : selection.selected)
    if (term.is_effect()) out.effects.push_back(term.candidate.name(before.drive()));
  out.gap_closed = gap_closed(before.square, selection.best.square, evidence.noise);
  if (out.effects.empty())
    for (const SelectedTerm& term : selection.selected)
      out.effects.push_back(fmt::format("another value of {}", term.candidate.name(before.drive())));
  if (out.effects.empty() && out.gap_closed > kMostlyClosed) out.effects.emplace_back("another calibration");
  if (out.effects.empty()) return {};
  out.rmse_after = std::sqrt(selection.best.square) * kMm;
  out.objections = selection.objections;
  if (out.objections.empty()) out.objections.push_back(reason_against(before, selection, evidence));
  return out;
}

}  // namespace

void set_proposed_model(FoundGap& found, const Hypothesis& proposed, const Evidence& evidence) {
  PlantModel model = rounded(proposed).model;
  const std::string& term = model.terms.back().name;
  for (const Unknown& u : proposed.unknowns) {
    if (u.effect != kTerm)
      found.proposed_changed.push_back({parameter_name(u, model.baseline.drive), value_std(u)});
    else if (u.parameter % kTermUnknowns < kMostTermParts)
      found.proposed_changed.push_back(
          {fmt::format("{}.{}", term, coefficient_name(u.parameter % kTermUnknowns)), u.value_std()});
  }
  if (!model.effects.sensor_noise) add_sensor_noise(model, found.proposed_changed, evidence.noise);
  std::ranges::sort(model.terms, {}, &Term::name);
  found.proposed_model = std::move(model);
}

FoundGap make_finding(const PlantModel& given, const ScoredModel& before, const Selection& selection,
                      const Evidence& evidence) {
  FoundGap found;
  GapFinding& f = found.finding;
  const Drive drive = given.baseline.drive;
  f.force_drive = drive == Drive::Force;
  f.verdict = verdict(before, selection, evidence);
  const bool adopted = f.verdict == GapVerdict::Effect || f.verdict == GapVerdict::Parameter;
  Hypothesis best = rounded(selection.best.hypothesis);
  std::optional<GapEstimate> phase;
  if (auto& wave = best.model.effects.periodic_disturbance) {
    phase = common_phase(best.model, evidence);
    wave->phase = phase->value / kDegrees;
  }
  found.model = adopted ? best.model : given;
  f.noise_floor = evidence.noise * kMm;
  f.noise_std = evidence.noise_std * kMm;
  f.noise_given = evidence.noise_given;
  f.rmse_before = std::sqrt(before.square) * kMm;
  f.rmse_after = adopted ? std::sqrt(selection.best.square) * kMm : f.rmse_before;
  f.gap_closed = adopted ? gap_closed(before.square, selection.best.square, evidence.noise) : 0.0;
  f.candidates = candidates_of(selection, drive);
  if (f.verdict == GapVerdict::Effect)
    for (const SelectedTerm& term : selection.selected)
      if (term.is_effect()) f.effects.push_back(describe(term, best));
  say_friction_by_direction(f.effects, best.model.effects);
  f.partial = f.verdict == GapVerdict::Effect && !is_whole(selection, evidence);
  if (f.verdict == GapVerdict::Unexplained) f.rejected = rejected_name(before, selection, evidence);
  for (FoundEffect& effect : f.effects)
    if (phase && effect.name == PeriodicDisturbance::info.name) effect.parameters.push_back(*phase);
  if (adopted) add_changed_parameters(found, given, best);
  if (adopted && !found.model.effects.sensor_noise)
    add_sensor_noise(found.model, found.changed, evidence.noise);
  name_runs(f, evidence);
  const std::vector<double> r_before = residual(before.hypothesis.model, evidence, Part::All);
  const std::vector<double> r_after = adopted ? residual(found.model, evidence, Part::All) : r_before;
  f.where = localize_residual(evidence, r_before, r_after, drive);
  const MainRegimes regimes = main_regime(evidence, r_before, drive);
  f.regime_names = regimes.names;
  f.fits = run_fits(evidence, r_before, r_after);
  f.signals = signals(evidence, r_before, r_after);
  f.traces = traces(evidence, r_before, r_after, regimes, drive);
  if (f.verdict == GapVerdict::Unexplained)
    f.shapes = residual_shapes(evidence, selection.start.hypothesis.model,
                               residual(selection.start.hypothesis.model, evidence, Part::All));
  if (f.verdict != GapVerdict::NoGap) found.rivals = rivals_of(selection);
  f.next = experiment_between(found.rivals, evidence);
  return found;
}

}  // namespace biopsy::sim::gap
