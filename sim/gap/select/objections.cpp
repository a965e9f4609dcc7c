#include "sim/gap/select/objections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "sim/gap/fit/fit.hpp"
#include "sim/gap/millimetres.hpp"
#include "sim/gap/residual/flexible.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/residual/run_fit.hpp"
#include "sim/gap/select/choose.hpp"
#include "sim/gap/select/compare_candidates.hpp"
#include "sim/gap/select/exchange.hpp"
#include "sim/gap/select/keep_simpler.hpp"
#include "sim/gap/select/verdict.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kHalf = 0.5;           // of the RMSE above the noise that no calibration explains
constexpr double kWhole = 0.95;         // of it
constexpr double kOfRange = 0.15;       // of the range of motion, that a name must not leave,
constexpr double kOfMotion = 0.5;       // and of the motion itself: a fit of 50 %
constexpr double kOfPlace = 0.5;        // of that range, by which a place must be known
constexpr double kNearNoise = 1.0;      // noises that are left
constexpr double kFlexibleWins = 0.8;   // of the excess square that a name leaves
constexpr double kAddsToCurve = 0.7;    // of the excess square that the curve leaves
constexpr double kNumberCloses = 0.75;  // of it, by a number of the baseline: what lacks resembles that
constexpr double kStillCloses = 0.5;    // with the runs exchanged
constexpr double kContradicts = 2.0;    // standard deviations
constexpr std::size_t kFewRows = 5;
constexpr double kJumps = 2.5;             // RMS of what is left, of which a fast ringing reaches two
constexpr double kStructured = 0.5;        // of the excess square that better numbers leave
constexpr double kShows = 0.25;            // noises, of it: less has no structure that could be seen
constexpr double kSameStds = 4.0;          // between the two fits of a strength,
constexpr double kSameShare = 0.5;         // and of it
constexpr double kSameShareOfLeft = 0.25;  // of the lesser excess square
constexpr int kExchangedIterations = 8;
constexpr std::string_view kDryFriction = "coulomb_N_per_mm";  // of a shaft

bool is_near_noise(double left, const Evidence& evidence) {
  return std::sqrt(excess(left, evidence)) < kNearNoise * evidence.noise;
}

double closed_by_names(const Selection& selection, const Evidence& evidence) {
  return gap_closed(selection.start.square, selection.best.square, evidence.noise);
}

bool is(const SelectedTerm& term, std::string_view name) {
  return is_effect(term.candidate, name);
}

bool selected(const Selection& selection, const Unknown& u) {
  return std::ranges::any_of(selection.selected, [&](const SelectedTerm& term) {
    return term.is_effect() && term.candidate.effect == u.effect;
  });
}

// Where the given model is far off, anything that takes its error away closes nearly all of the gap and
// explains no motion.
void add_left_motion(std::vector<std::string>& out, const Selection& selection, const Evidence& evidence) {
  if (is_near_noise(selection.best.square, evidence)) return;
  const double left = std::sqrt(excess(selection.best.square, evidence)), motion = held_out_motion(evidence);
  const double share = left / (evidence.x_high - evidence.x_low);
  if (share > kOfRange)
    out.push_back(
        fmt::format("it leaves {:.3g} mm, {:.0f} % of the range of motion", left * kMm, 100.0 * share));
  else if (motion > evidence.noise && left > kOfMotion * motion)
    out.push_back(
        fmt::format("it leaves {:.3g} mm of a held-out motion of {:.3g} mm (RMS)", left * kMm, motion * kMm));
}

// The same in every row of every run: its unit, its sign and a force beside it cannot be told apart.
void add_constant_input(std::vector<std::string>& out, const Selection& selection, const Evidence& evidence) {
  if (std::ranges::none_of(selection.selected,
                           [](const SelectedTerm& term) { return is(term, ExternalForce::info.name); }))
    return;
  const double input = evidence.runs.front().rows.front().input;
  for (const EvidenceRun& run : evidence.runs)
    if (!std::ranges::all_of(run.rows, [&](const Row& row) { return row.input == input; })) return;
  out.push_back(fmt::format(
      "the input is {:.4g} in all runs, where a constant force looks like a wrong unit or sign of "
      "it: record another input",
      input));
}

// Of each effect at least one strength, and where and above which level it acts, must be known.
void add_unknown_parameters(std::vector<std::string>& out, const Selection& selection,
                            const Evidence& evidence) {
  for (const SelectedTerm& term : selection.selected) {
    if (!term.is_effect()) continue;
    const LibraryEffect& effect = library_effect(term.candidate.effect);
    bool any_strength = false, known_strength = false;
    for (const Unknown& u : selection.best.hypothesis.unknowns) {
      if (u.effect != term.candidate.effect || !std::isfinite(u.std)) continue;
      const LibraryParameter& p = effect.parameters[u.parameter];
      const double std = u.value_std(), range = evidence.x_high - evidence.x_low;
      if (p.role == Role::Strength) any_strength = true, known_strength |= std < std::abs(u.value());
      const bool unknown_place = p.role == Role::Place && std > kOfPlace * range,
                 unknown_level = p.role == Role::Level && std > std::abs(u.value());
      if (unknown_place || unknown_level)
        out.push_back(fmt::format("its {} is known to no better than {:.2g} +- {:.2g}", p.name,
                                  u.value() / p.si_per_unit, std / p.si_per_unit));
    }
    if (any_strength && !known_strength)
      out.push_back(fmt::format("no strength of {} is known to better than itself", effect.info.name));
  }
}

// Root sum of squares over the effect's strengths.
double strength_std(const Hypothesis& hypothesis, int effect) {
  double std = 0.0;
  for (const Unknown& u : hypothesis.unknowns)
    if (u.effect == effect && library_effect(effect).parameters[u.parameter].role == Role::Strength)
      std = std::hypot(std, u.value_std());
  return std;
}

// A fit may use an effect for something else than its name says: a drag that grows with the root of the speed
// is friction that grows from breakaway to sliding; a spring that yields at once is dry friction; a stop is
// tissue that does not relax; thick grease at one end is a shaft that tissue holds without rubbing on it; a
// gain that falls with the voltage is a bend without the limit that it leads to.
void add_contradictions(std::vector<std::string>& out, const Selection& selection, const Evidence& evidence) {
  const Hypothesis& best = selection.best.hypothesis;
  double longest = 0.0;
  for (const EvidenceRun& run : evidence.runs)
    longest = std::max(longest, run.rows.back().time + run.rows.back().span);
  for (const SelectedTerm& term : selection.selected) {
    if (is(term, StribeckFriction::info.name)) {
      const StribeckFriction& friction = *best.model.effects.stribeck_friction;
      if (friction.sliding - friction.breakaway > kContradicts * strength_std(best, term.candidate.effect))
        out.push_back(
            fmt::format("it would break away at {:.2g} N and need {:.2g} N to keep sliding, the opposite of "
                        "its name",
                        friction.breakaway, friction.sliding));
      else if (friction.breakaway - friction.sliding < strength_std(best, term.candidate.effect))
        out.push_back(
            fmt::format("its breakaway, {:.2g} N, is not known to be above its sliding friction, {:.2g} N: "
                        "dry friction without what it is named for",
                        friction.breakaway, friction.sliding));
    }
    if (is(term, HystereticSpring::info.name) && best.model.effects.hysteretic_spring->yield < evidence.noise)
      out.push_back(fmt::format(
          "it would yield at {:.2g} mm, less than one reading resolves ({:.2g} mm): dry friction, "
          "not a spring",
          1e3 * best.model.effects.hysteretic_spring->yield, 1e3 * evidence.noise));
    if (is(term, LugreFriction::info.name)) {
      const LugreFriction& friction = *best.model.effects.lugre_friction;
      const double slips_at = friction.steady(0.0) / friction.stiffness;
      if (slips_at < kBendSeen * evidence.noise)
        out.push_back(fmt::format(
            "its bristles would slip at {:.2g} mm, too little to be seen with a noise of {:.2g} mm: "
            "dry friction without them",
            1e3 * slips_at, 1e3 * evidence.noise));
    }
    if (is(term, TissueRelaxation::info.name) && best.model.effects.tissue_relaxation->time > longest)
      out.push_back(fmt::format(
          "its force would relax in {:.2g} s, longer than any run: an elastic stop without relaxation",
          best.model.effects.tissue_relaxation->time));
    if (is(term, VoltageSaturation::info.name) &&
        best.model.effects.voltage_saturation->level > evidence.u_max)
      out.push_back(
          fmt::format("its limit of {:.2g} kV is above every recorded voltage: a gain that falls with the "
                      "voltage, not an amplifier at its limit",
                      1e-3 * best.model.effects.voltage_saturation->level));
    if (is(term, ShaftFriction::info.name))
      for (const Unknown& u : best.unknowns)
        if (u.effect == term.candidate.effect &&
            library_effect(u.effect).parameters[u.parameter].name == kDryFriction &&
            !(u.value() > kContradicts * u.value_std()))
          out.emplace_back(
              "it would be a drag that grows with depth, without the friction that it is named for");
  }
}

// The largest change of the mean of a few residuals to that of the next few, m.
double largest_jump(const std::vector<double>& r, const Evidence& evidence) {
  double most = 0.0;
  std::size_t first = 0;
  for (const EvidenceRun& run : evidence.runs) {
    for (std::size_t i = first; i + 2 * kFewRows <= first + run.rows.size(); ++i) {
      double apart = 0.0;
      for (std::size_t j = i; j < i + kFewRows; ++j) apart += (r[j + kFewRows] - r[j]) / kFewRows;
      most = std::max(most, std::abs(apart));
    }
    first += run.rows.size();
  }
  return most;
}

// A reading that jumps, because a clamp slipped, is fitted as a drift that settles.
void add_jump(std::vector<std::string>& out, const Selection& selection, const Evidence& evidence) {
  if (std::ranges::none_of(selection.selected,
                           [](const SelectedTerm& term) { return is(term, SensorDrift::info.name); }))
    return;
  const std::vector<double> left = residual(selection.best.hypothesis.model, evidence, Part::All);
  const double jump = largest_jump(left, evidence);
  if (jump > kJumps * std::sqrt(mean_square(left)))
    out.push_back(
        fmt::format("what it leaves jumps by {:.2g} mm within a few readings: no drift", 1e3 * jump));
}

// Trained on the held-out runs, tested on the others.
void add_instability(std::vector<std::string>& out, const Selection& selection, const Evidence& evidence) {
  if (!can_exchange(evidence)) return;
  const Evidence other = exchanged(evidence);
  Hypothesis hypothesis = selection.best.hypothesis;
  fit(hypothesis, other, kExchangedIterations);
  Hypothesis start = selection.start.hypothesis;
  fit(start, other, kExchangedIterations);
  const double before = score_model(start, other).square, after = score_model(hypothesis, other).square;
  const double closed = gap_closed(before, after, other.noise);
  if (!is_near_noise(after, other) && closed < kStillCloses)
    out.push_back(fmt::format("with training and held-out runs exchanged it closes {:.0f} % of the gap",
                              100.0 * closed));
  estimate_uncertainty(hypothesis, other);
  for (std::size_t i = 0; i < hypothesis.unknowns.size(); ++i) {
    const Unknown &a = selection.best.hypothesis.unknowns[i], &b = hypothesis.unknowns[i];
    if (!selected(selection, a) || library_effect(a.effect).parameters[a.parameter].role != Role::Strength)
      continue;
    const double apart = std::abs(a.value() - b.value());
    if (apart > kSameStds * std::hypot(a.value_std(), b.value_std()) &&
        apart > kSameShare * std::max(std::abs(a.value()), std::abs(b.value())))
      out.push_back(fmt::format("its {} differs between the runs",
                                library_effect(a.effect).parameters[a.parameter].name));
  }
}

// A number of the baseline and an effect that were both needed and leave something: either may make up for
// what is missing.
void add_other_numbers(std::vector<std::string>& out, const Selection& selection) {
  for (const SelectedTerm& term : selection.selected)
    if (!term.is_effect())
      out.push_back(fmt::format("it needs another value of {} beside it and still leaves more than noise",
                                term.candidate.name(selection.best.drive())));
}

bool same_prediction(const ScoredModel& a, const ScoredModel& b, const Evidence& evidence) {
  double apart = 0.0;
  for (std::size_t i = 0; i < a.residual.size(); ++i) apart += std::pow(a.residual[i] - b.residual[i], 2);
  const double least = std::min(excess(a.square, evidence), excess(b.square, evidence));
  return apart < kSameShareOfLeft * least * static_cast<double>(a.residual.size());
}

bool is_hysteretic(const Candidate& candidate) {
  return is_effect(candidate, HystereticSpring::info.name) ||
         is_effect(candidate, HardeningHysteresis::info.name);
}

// Their limit of no yield, or of stiff bristles, is dry friction.
bool contains_dry_friction(const Candidate& candidate) {
  return is_effect(candidate, HystereticSpring::info.name) || is_effect(candidate, LugreFriction::info.name);
}

// What leaves something must at least leave far less than any other candidate, unless that is the same by
// another name: shaft friction that begins far above the needle is Coulomb friction. Of two that explain
// most, either may be the wrong name; a hysteretic spring or LuGre friction does not compete with the
// friction that it contains.
void add_rival(std::vector<std::string>& out, const Selection& selection, const Evidence& evidence) {
  for (const SelectedTerm& term : selection.selected) {
    const auto own = std::ranges::find(term.comparison, term.candidate, &CandidateFit::candidate);
    if (!term.is_effect() || own == term.comparison.end()) continue;
    for (const CandidateFit& t : term.comparison) {
      if (t.candidate == term.candidate || !t.fitted) continue;
      const double closed = gap_closed(selection.start.square, t.scored.square, evidence.noise);
      if (selection.selected.size() == 1 && t.candidate.effect == kBaseline && closed > kNumberCloses) {
        out.push_back(
            fmt::format("another value of {} alone closes {:.0f} % of the gap: what is missing may "
                        "make that vary by a law of its own",
                        t.candidate.name(selection.best.drive()), 100.0 * closed));
        return;
      }
      if (!(t.scored.square < kClearMargin * own->scored.square)) continue;
      const bool nested = is_dry_friction(term.candidate) &&
                          (is_dry_friction(t.candidate) || bends_unseen(t, evidence) ||
                           (contains_dry_friction(t.candidate) && t.scored.square > own->scored.square));
      if (nested || same_prediction(t.scored, own->scored, evidence)) continue;
      out.push_back(fmt::format("{} leaves nearly as little as {}", t.candidate.name(selection.best.drive()),
                                term.candidate.name(selection.best.drive())));
      return;
    }
  }
}

// A curve of its own may fit better than a name that leaves something; but then the name must add to it what
// no curve can, such as a jump.
void add_flexible(std::vector<std::string>& out, const Selection& selection, const Evidence& coarse) {
  const std::vector<FlexibleFit> curves = fit_flexible(selection.start, coarse);
  if (curves.empty()) return;
  const FlexibleFit& curve = curves.front();
  const double left =
      excess(mean_square(residual(selection.best.hypothesis.model, coarse, Part::HeldOut)), coarse);
  const double by_curve = excess(curve.square, coarse);
  if (by_curve > kFlexibleWins * left) return;
  const std::vector<FlexibleFit> both = fit_flexible(selection.best, coarse);
  const auto same = std::ranges::find_if(
      both, [&](const FlexibleFit& one) { return one.acts == curve.acts && one.variable == curve.variable; });
  if (same != both.end() && excess(same->square, coarse) < kAddsToCurve * by_curve) return;
  out.push_back(fmt::format("a {} as an additional {} leaves less ({:.3g} mm) than it does ({:.3g} mm)",
                            curve.name(), curve.acts, 1e3 * std::sqrt(curve.square),
                            1e3 * std::sqrt(selection.best.square)));
}

// Whether holds(mean square before, left) for the held-out runs; where these could not decide alone, for the
// training runs too.
template <class Condition>
bool in_all_that_decided(const Selection& selection, const Evidence& evidence, const Condition& holds) {
  const auto training = [&](const ScoredModel& scored) {
    return mean_square(residual(scored.hypothesis.model, evidence, Part::Training));
  };
  return holds(selection.start.square, selection.best.square) &&
         (!selection.by_both || holds(training(selection.start), training(selection.best)));
}

bool leaves_noise(const Selection& selection, const Evidence& evidence) {
  return in_all_that_decided(selection, evidence,
                             [&](double, double left) { return is_near_noise(left, evidence); });
}

// Guesses of mass, damping and stiffness that are wrong together leave what no single one of them explains,
// and an effect may take away.
void add_numbers_together(std::vector<std::string>& out, const Selection& selection,
                          const Evidence& evidence) {
  const std::optional<ScoredModel> numbers = with_numbers_free(selection.start, evidence);
  if (!numbers) return;
  const double closed = gap_closed(selection.start.square, numbers->square, evidence.noise);
  const bool as_good = numbers->square < kClearMargin * selection.best.square;
  if (as_good || (closed > kNumberCloses && !leaves_noise(selection, evidence)))
    out.push_back(fmt::format("other values of {} without it close {:.0f} % of the gap: fit them (--free)",
                              names_of_numbers(numbers->hypothesis), 100.0 * closed));
}

}  // namespace

bool is_whole(const Selection& selection, const Evidence& evidence) {
  return in_all_that_decided(selection, evidence, [&](double before, double left) {
    return is_near_noise(left, evidence) || gap_closed(before, left, evidence.noise) >= kWhole;
  });
}

std::vector<std::string> objections(const Selection& selection, const Evidence& coarse,
                                    const Evidence& fine) {
  std::vector<std::string> out;
  const double closed = closed_by_names(selection, fine);
  for (const SelectedTerm& term : selection.selected)
    if (is_hysteretic(term.candidate) && !well_explained(selection.start.square, selection.best.square, fine))
      out.push_back(fmt::format(
          "its many numbers fit much that is no such spring, and it closes {:.0f} % only", 100.0 * closed));
  for (const SelectedTerm& term : selection.selected)
    if (resembles_many(term.candidate) &&
        std::sqrt(excess(selection.best.square, fine)) > kHardlyMore * fine.noise)
      out.push_back(fmt::format("it leaves {:.3g} mm, and {} resembles many a law that would leave as little",
                                kMm * std::sqrt(selection.best.square),
                                term.candidate.name(selection.best.drive())));
  if (closed < kHalf && !is_near_noise(selection.best.square, fine))
    out.push_back(fmt::format("it closes {:.0f} % of the gap that no calibration explains", 100.0 * closed));
  add_left_motion(out, selection, fine);
  add_unknown_parameters(out, selection, fine);
  add_contradictions(out, selection, fine);
  add_constant_input(out, selection, fine);
  if (out.empty()) add_numbers_together(out, selection, fine);
  // What is closed to the noise on held-out runs has shown itself; one run of a few may hold no puncture.
  if (!out.empty() || leaves_noise(selection, fine)) return out;
  add_other_numbers(out, selection);
  add_jump(out, selection, fine);
  add_rival(out, selection, fine);
  if (out.empty()) add_instability(out, selection, coarse);
  if (out.empty()) add_flexible(out, selection, coarse);
  return out;
}

std::vector<std::string> objections_to_numbers(const Selection& selection, const Evidence& coarse) {
  if (!tells_a_number(selection.best.hypothesis))
    return {fmt::format("values five times as large or small of {} follow the record as well",
                        names_of_numbers(selection.best.hypothesis))};
  const double left =
      excess(mean_square(residual(selection.best.hypothesis.model, coarse, Part::HeldOut)), coarse);
  if (std::sqrt(left) < kShows * coarse.noise) return {};
  const std::vector<FlexibleFit> curves = fit_flexible(selection.best, coarse, true);
  if (curves.empty() || excess(curves.front().square, coarse) > kStructured * left) return {};
  const FlexibleFit& curve = curves.front();
  return {fmt::format("what it leaves ({:.3g} mm where the noise is {:.3g} mm) follows a {} that acts on {}",
                      1e3 * std::sqrt(selection.best.square), 1e3 * coarse.noise, curve.name(), curve.acts)};
}

}  // namespace biopsy::sim::gap
