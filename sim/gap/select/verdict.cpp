#include "sim/gap/select/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace biopsy::sim::gap {
namespace {

constexpr double kWellClosed = 0.9;      // of the RMSE above the noise
constexpr double kWellBelowNoise = 0.5;  // what is left, in shares of the noise
constexpr double kHardlyMore = 0.25;     // excess square, in squares of the noise
constexpr double kNoticed = 0.05;
constexpr double kLeastClosed = 0.6;     // enough where one candidate leaves all others behind:
constexpr double kBent = 3.0;            // standard deviations of a calibration
constexpr double kFarAhead = 1.4 * 1.4;  // mean square of the next that predicts something else

// Only noise, or so little more that no number of the baseline makes it less: the noise is not known better.
bool is_hardly_a_gap(double before, double after, const Evidence& evidence) {
  if (is_only_noise(before, evidence)) return true;
  const double noise = evidence.noise * evidence.noise;
  return excess(before, evidence) < kHardlyMore * noise && before - after < kNoticed * noise;
}

// Whether the explanation holds only if the calibration is wrong as well: then both make up for something
// else.
bool bends_calibration(const Hypothesis& hypothesis) {
  return std::any_of(hypothesis.unknowns.begin(), hypothesis.unknowns.end(), [](const Unknown& u) {
    return u.effect == kBaseline && std::isfinite(u.prior_std) &&
           std::abs(u.theta - u.prior_mean) > kBent * u.prior_std;
  });
}

}  // namespace

double gap_closed(double before, double after, double noise) {
  const double gap = std::sqrt(before) - noise;
  return gap <= 0.0 ? 0.0 : std::clamp((std::sqrt(before) - std::sqrt(after)) / gap, 0.0, 1.0);
}

bool well_explained(double before, double after, const Evidence& evidence) {
  return std::sqrt(excess(after, evidence)) < kWellBelowNoise * evidence.noise ||
         gap_closed(before, after, evidence.noise) >= kWellClosed;
}

double lead(const Selection& selection) {
  const auto first = std::find_if(selection.selected.begin(), selection.selected.end(),
                                  [](const SelectedTerm& term) { return term.is_effect(); });
  double next = std::numeric_limits<double>::infinity();
  if (first == selection.selected.end()) return next;
  double own = selection.best.square;
  for (const CandidateFit& t : first->contest) {
    if (t.candidate == first->candidate)
      own = t.judged.square;
    else if (t.fitted && !t.indistinguishable)
      next = std::min(next, t.judged.square);
  }
  return next / own;
}

GapVerdict verdict(const ScoredModel& before, const Selection& selection, const Evidence& evidence) {
  if (selection.selected.empty() && is_hardly_a_gap(before.square, selection.best.square, evidence))
    return GapVerdict::NoGap;
  const bool closed = well_explained(before.square, selection.best.square, evidence);
  if (std::none_of(selection.selected.begin(), selection.selected.end(),
                   [](const SelectedTerm& term) { return term.is_effect(); }))
    return closed ? GapVerdict::Parameter : GapVerdict::Unexplained;
  const bool stands_out = gap_closed(before.square, selection.best.square, evidence.noise) >= kLeastClosed &&
                          lead(selection) >= kFarAhead && !bends_calibration(selection.best.hypothesis);
  return closed || stands_out ? GapVerdict::Effect : GapVerdict::Unexplained;
}

}  // namespace biopsy::sim::gap
