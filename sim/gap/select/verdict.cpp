#include "sim/gap/select/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/gap/millimetres.hpp"
#include "sim/gap/residual/predict.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kWellClosed = 0.9;      // of the RMSE above the noise
constexpr double kWellBelowNoise = 0.5;  // remainder, in noises
constexpr double kFollows = 0.005;       // of the range of motion
constexpr double kOneNoise = 1.0;        // remainder, in noises
constexpr double kSlightExcess = 0.25;   // excess square, in squares of the noise
constexpr double kNoticed = 0.05;        // change of the mean square, in squares of the noise
constexpr double kLeastClosed =
    0.695;  // of the RMSE, shown as 70 %: enough where one candidate has a clear margin
constexpr double kCalibrationStds = 3.0;  // a baseline parameter is not that far off by calibration alone

// Noise, or slightly more that no baseline parameter reduces: the noise is not known more precisely.
bool is_negligible(double before, double after, const Evidence& evidence) {
  if (is_only_noise(before, evidence)) return true;
  const double noise = evidence.noise * evidence.noise;
  return excess(before, evidence) < kSlightExcess * noise && before - after < kNoticed * noise;
}

// The explanation holds only together with a large calibration error: then both compensate for something
// else.
bool relies_on_calibration_error(const Hypothesis& hypothesis) {
  return std::any_of(hypothesis.unknowns.begin(), hypothesis.unknowns.end(), [](const Unknown& u) {
    return u.effect == kBaseline && std::isfinite(u.prior_std) &&
           std::abs(u.theta - u.prior_mean) > kCalibrationStds * u.prior_std;
  });
}

// What is left is small against the motion: a gap that wrong numbers made large is closed by any better ones.
bool follows(double after, const Evidence& evidence) {
  const double left = std::sqrt(excess(after, evidence));
  return left < kWellBelowNoise * evidence.noise || left < kFollows * (evidence.x_high - evidence.x_low);
}

// Near the noise as well: of a fine sensor half a per cent of the motion is much.
bool follows_closely(double after, const Evidence& evidence) {
  return follows(after, evidence) && std::sqrt(excess(after, evidence)) < kOneNoise * evidence.noise;
}

// Held-out runs may not reach where the model fails.
bool follows_training(const ScoredModel& best, const Evidence& evidence) {
  return follows(mean_square(residual(best.hypothesis.model, evidence, Part::Training)), evidence);
}

// The first effect that was selected, what it leaves, and the least that another candidate leaves which
// predicts something else; m^2.
struct Next {
  double own = 0.0, square = std::numeric_limits<double>::infinity();
  const CandidateFit* candidate = nullptr;
};

Next next_to_first(const Selection& selection) {
  const auto first = std::find_if(selection.selected.begin(), selection.selected.end(),
                                  [](const SelectedTerm& term) { return term.is_effect(); });
  Next out{.own = selection.best.square};
  if (first == selection.selected.end()) return out;
  for (const CandidateFit& t : first->comparison) {
    if (t.candidate == first->candidate)
      out.own = t.scored.square;
    else if (t.fitted && !t.indistinguishable && t.scored.square < out.square)
      out.square = t.scored.square, out.candidate = &t;
  }
  return out;
}

bool has_effect(const Selection& selection) {
  return std::ranges::any_of(selection.selected, &SelectedTerm::is_effect);
}

}  // namespace

double gap_closed(double before, double after, double noise) {
  if (!std::isfinite(before)) return std::isfinite(after) ? 1.0 : 0.0;
  const double gap = std::sqrt(before) - noise;
  return gap <= 0.0 ? 0.0 : std::clamp((std::sqrt(before) - std::sqrt(after)) / gap, 0.0, 1.0);
}

bool well_explained(double before, double after, const Evidence& evidence) {
  if (!std::isfinite(before)) return follows(after, evidence);  // of an endless gap any share is closed
  return std::sqrt(excess(after, evidence)) < kWellBelowNoise * evidence.noise ||
         gap_closed(before, after, evidence.noise) >= kWellClosed;
}

double margin_over_next(const Selection& selection) {
  const Next next = next_to_first(selection);
  return next.square / next.own;
}

std::string reason_against(const ScoredModel& before, const Selection& selection, const Evidence& evidence) {
  const double square = selection.best.square;
  const double left = std::sqrt(excess(square, evidence)) * kMm;
  if (!has_effect(selection)) {
    if (!follows_training(selection.best, evidence))
      return "the runs to which it was fitted are not followed either";
    return fmt::format("{:.3g} mm are left beyond the noise", left);
  }
  const Next next = next_to_first(selection);
  if (next.candidate != nullptr && next.square / next.own < kClearMargin)
    return fmt::format("{} leaves nearly as little ({:.3g} mm where it leaves {:.3g} mm)",
                       next.candidate->candidate.name(before.drive()), std::sqrt(next.square) * kMm,
                       std::sqrt(next.own) * kMm);
  if (relies_on_calibration_error(selection.best.hypothesis))
    return "it needs numbers of the model that are off by more than a calibration is";
  return fmt::format("{:.3g} mm are left beyond the noise, {:.0f} % of the gap", left,
                     100.0 * (1.0 - gap_closed(before.square, square, evidence.noise)));
}

GapVerdict verdict(const ScoredModel& before, const Selection& selection, const Evidence& evidence) {
  const bool closed = well_explained(before.square, selection.best.square, evidence);
  if (!has_effect(selection)) {
    if (!follows_training(selection.best, evidence)) return GapVerdict::Unexplained;
    if (selection.selected.empty() && is_negligible(before.square, selection.best.square, evidence))
      return GapVerdict::NoGap;
    return closed && follows_closely(selection.best.square, evidence) && selection.objections.empty()
               ? GapVerdict::Parameter
               : GapVerdict::Unexplained;
  }
  const bool stands_out = gap_closed(before.square, selection.best.square, evidence.noise) >= kLeastClosed &&
                          margin_over_next(selection) >= kClearMargin &&
                          !relies_on_calibration_error(selection.best.hypothesis);
  return selection.objections.empty() && (closed || stands_out) ? GapVerdict::Effect
                                                                : GapVerdict::Unexplained;
}

}  // namespace biopsy::sim::gap
