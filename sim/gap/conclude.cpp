#include "sim/gap/conclude.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/gap/predict.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kMm = 1e3;
constexpr double kWellClosed = 0.9;        // of the RMSE above the noise
constexpr double kWellBelowNoise = 0.5;    // what is left, in shares of the noise
constexpr double kLeastClosed = 0.6;       // where one candidate stands out from all others
constexpr double kStandsOut = 1.4;         // next best held-out RMSE over its own
constexpr double kMovedStds = 3.0;         // a calibration error worth telling
constexpr double kMovedShare = 0.002;
constexpr double kWorthNaming = 0.005;     // probability of a rival

bool well_explained(double before, double after, const Evidence& evidence) {
  if (std::sqrt(excess(after, evidence)) < kWellBelowNoise * evidence.noise) return true;
  return std::sqrt(before) - std::sqrt(after) >= kWellClosed * (std::sqrt(before) - evidence.noise);
}

double gap_closed(double before, double after, double noise) {
  const double gap = std::sqrt(before) - noise;
  return gap <= 0.0 ? 0.0 : std::clamp((std::sqrt(before) - std::sqrt(after)) / gap, 0.0, 1.0);
}

bool stands_out(const Selection& selection) {
  const Trial* winner = nullptr;
  double next = std::numeric_limits<double>::infinity();
  for (const Trial& t : selection.trials) {
    if (t.round != 1 || !t.fitted) continue;
    if (t.chosen) winner = &t;
    else next = std::min(next, t.held_out_square);
  }
  return winner != nullptr && next > kStandsOut * kStandsOut * winner->held_out_square;
}

std::string number_name(const Unknown& u, Drive drive) {
  if (u.effect == kBaseline) return std::string(uncertain_baseline(drive)[u.parameter].name);
  const LibraryEffect& effect = library()[static_cast<std::size_t>(u.effect)];
  return fmt::format("{}.{}", effect.info.name, effect.parameters[u.parameter].name);
}

double value_std(const Unknown& u) {  // SI
  return u.logarithmic ? u.value() * u.std : std::abs(u.scale) * u.std;
}

FoundEffect describe(const Candidate& candidate, const Hypothesis& best, const Selection& selection,
                     std::size_t entered) {
  const LibraryEffect& effect = library()[static_cast<std::size_t>(candidate.effect)];
  FoundEffect out;
  out.name = effect.info.name;
  out.sentence = effect.info.sentence;
  for (const Unknown& u : best.unknowns)
    if (u.effect == candidate.effect) {
      const LibraryParameter& p = effect.parameters[u.parameter];
      out.parameters.push_back({std::string(p.name), u.value() / p.si_per_unit, value_std(u) / p.si_per_unit});
    }
  const int round = static_cast<int>(entered) + 1;
  for (const Trial& t : selection.trials) {
    if (t.round != round || !t.fitted) continue;
    if (t.chosen) out.probability = t.probability;
    else if (t.probability >= kWorthNaming)
      out.confused_with.push_back({t.candidate.name(best.model.baseline.drive), t.probability});
  }
  const double first = selection.squares[entered];
  out.share_explained = first <= 0.0 ? 0.0 : 1.0 - selection.squares[entered + 1] / first;
  return out;
}

void tell_changes(FoundGap& found, const PlantModel& given, const Hypothesis& best) {
  const Drive drive = given.baseline.drive;
  for (const Unknown& u : best.unknowns) {
    found.changed.push_back({number_name(u, drive), value_std(u)});
    if (u.effect != kBaseline) {
      const LibraryParameter& p = library()[static_cast<std::size_t>(u.effect)].parameters[u.parameter];
      found.changed.back().std /= p.si_per_unit;
      continue;
    }
    const double was = given.baseline.*(uncertain_baseline(drive)[u.parameter].member);
    const double moved = std::abs(u.value() - was);
    const bool free = !std::isfinite(u.prior_std);
    if (free || (moved > kMovedStds * value_std(u) && moved > kMovedShare * was))
      found.finding.parameters_changed.push_back({number_name(u, drive), was, u.value(), value_std(u)});
  }
}

GapVerdict verdict_of(const Selection& selection, double before, double after, const Evidence& evidence) {
  if (is_only_noise(before, evidence)) return GapVerdict::NoGap;
  const bool named = std::any_of(selection.chosen.begin(), selection.chosen.end(),
                                 [](const Candidate& c) { return c.effect != kBaseline; });
  const bool closed = well_explained(before, after, evidence);
  if (named) {
    const bool enough = gap_closed(before, after, evidence.noise) >= kLeastClosed && stands_out(selection);
    return closed || enough ? GapVerdict::Effect : GapVerdict::Unexplained;
  }
  return closed ? GapVerdict::Parameter : GapVerdict::Unexplained;
}

std::vector<GapCandidate> candidates_of(const Selection& selection, Drive drive) {
  std::vector<GapCandidate> out;
  for (const Trial& t : selection.trials) {
    GapCandidate c;
    c.name = t.candidate.name(drive);
    c.kind = t.candidate.effect == kBaseline ? CandidateKind::Parameter : CandidateKind::Effect;
    c.round = t.round;
    c.score = t.share;
    c.fitted = t.fitted;
    if (t.fitted) c.held_out_rmse = std::sqrt(t.held_out_square) * kMm;
    c.probability = t.probability;
    c.chosen = t.chosen;
    out.push_back(c);
  }
  return out;
}

}  // namespace

FoundGap conclude(const PlantModel& given, const Hypothesis& before, const Selection& selection,
                  const Evidence& evidence) {
  FoundGap found;
  GapFinding& f = found.finding;
  const Drive drive = given.baseline.drive;
  const double was = held_out_square(before.model, evidence);
  const double is = held_out_square(selection.best.model, evidence);
  f.force_drive = drive == Drive::Force;
  f.verdict = verdict_of(selection, was, is, evidence);
  const bool adopted = f.verdict == GapVerdict::Effect || f.verdict == GapVerdict::Parameter;
  found.model = adopted ? selection.best.model : given;
  f.noise_floor = evidence.noise * kMm;
  f.noise_given = evidence.noise_given;
  f.rmse_before = std::sqrt(was) * kMm;
  f.rmse_after = std::sqrt(adopted ? is : was) * kMm;
  f.gap_closed = adopted ? gap_closed(was, is, evidence.noise) : 0.0;
  f.candidates = candidates_of(selection, drive);
  if (f.verdict == GapVerdict::Effect)
    for (std::size_t i = 0; i < selection.chosen.size(); ++i)
      if (selection.chosen[i].effect != kBaseline)
        f.effects.push_back(describe(selection.chosen[i], selection.best, selection, i));
  if (adopted) tell_changes(found, given, selection.best);
  for (const EvidenceRun& run : evidence.runs) {
    if (run.training_rows > 0) f.training_runs.push_back(run.name);
    if (run.training_rows < run.rows.size())
      f.held_out_runs.push_back(run.training_rows > 0 ? run.name + " (last third)" : run.name);
  }
  return found;
}

}  // namespace biopsy::sim::gap
