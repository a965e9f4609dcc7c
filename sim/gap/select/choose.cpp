#include "sim/gap/select/choose.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/gap/fit/fit.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/residual/window_starts.hpp"
#include "sim/gap/select/select.hpp"
#include "sim/plant/plant.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kWindow = 0.5;          // s: a few periods of the stage's ringing, a few stick-slip jumps
constexpr double kShortWindow = 2.0;     // times 1/fastest rate: a third of the mechanism's period
constexpr double kFewestReadings = 8.0;  // in a window
constexpr double kDrifts = 1.0;          // periods of the mechanism in a run; a spring of less holds nothing
constexpr double kDetermined = 0.2;      // ln
constexpr double kMoved = 0.1;           // ln, far beyond a calibration error of 2 %
constexpr double kFar = 1.0;             // ln
constexpr double kHalved = 0.5;          // excess square
constexpr int kIterations = 20;
constexpr double kDeparts = 5.0;         // noises RMS from a uniform motion, that a window shows
constexpr double kOther = 1.609;         // ln 5
constexpr double kFollowsAsWell = 1.05;  // mean square

double longest_run(const Dataset& dataset) {
  double longest = 0.0;
  for (const RecordedRun& run : dataset.runs)
    longest = std::max(longest, run.period * static_cast<double>(run.time.size()));
  return longest;
}

bool drifts(const Dataset& dataset, const Baseline& b) {
  const double period = b.k > 0.0 ? 2.0 * std::numbers::pi * std::sqrt(b.m / b.k) : 1e9;
  return period > longest_run(dataset) / kDrifts;
}

// From the uniform motion with which each window begins, m RMS.
double departure(const Dataset& dataset, double window, double noise) {
  double square = 0.0, readings = 0.0;
  for (const RecordedRun& run : dataset.runs) {
    const auto length = static_cast<std::size_t>(std::max(2.0, std::round(window / run.period)));
    std::vector<std::size_t> begins;
    for (std::size_t i = 0; i < run.time.size(); i += length) begins.push_back(i);
    const std::vector<StartMotion> starts = window_starts(run, begins, noise);
    for (std::size_t i = 0; i < run.time.size(); ++i) {
      const StartMotion& start = starts[i / length];
      const double uniform = start.x + start.v * (run.time[i] - run.time[begins[i / length]]);
      square += std::pow(run.displacement[i] - uniform, 2);
      readings += 1.0;
    }
  }
  return std::sqrt(square / readings);
}

// Of a mechanism: those that are not 0.
std::vector<std::string> numbers_of(const PlantModel& model) {
  std::vector<std::string> names;
  for (const UncertainParameter& p : uncertain_baseline(Drive::Force))
    if (model.baseline.*(p.member) > 0.0) names.emplace_back(p.name);
  return names;
}

// The model within its calibration errors, and with all numbers of its mechanism fitted freely.
struct Comparison {
  Evidence evidence;
  ScoredModel calibrated, freed;

  double least() const { return std::min(calibrated.square, freed.square); }
};

Comparison compared(const Dataset& dataset, const PlantModel& model, std::optional<double> window) {
  Comparison out{
      .evidence = prepare(dataset, model, window, Sampling::Coarse), .calibrated = {}, .freed = {}};
  const auto fitted = [&](const std::vector<std::string>& free) {
    Hypothesis hypothesis = baseline_hypothesis(model, free);
    fit(hypothesis, out.evidence, kIterations);
    return score_model(std::move(hypothesis), out.evidence);
  };
  out.calibrated = fitted({});
  out.freed = fitted(numbers_of(model));
  return out;
}

bool is_free(const Unknown& u) {
  return u.effect == kBaseline && !std::isfinite(u.prior_std);
}

// With that number elsewhere, and all others fitted to it.
bool follows_as_well(const ScoredModel& best, std::size_t number, double theta, const Evidence& evidence) {
  Hypothesis other = best.hypothesis;
  other.unknowns[number].theta = theta;
  std::vector<double> thetas;
  for (const Unknown& u : other.unknowns) thetas.push_back(u.theta);
  other.set(thetas);
  other.unknowns.erase(other.unknowns.begin() + static_cast<std::ptrdiff_t>(number));
  fit(other, evidence, kIterations);
  const auto square = [&](const PlantModel& model) {
    return mean_square(residual(model, evidence, Part::All));
  };
  return square(other.model) < kFollowsAsWell * square(best.hypothesis.model);
}

}  // namespace

double short_window(const Dataset& dataset, const PlantModel& model) {
  double period = 0.0;
  for (const RecordedRun& run : dataset.runs) period = std::max(period, run.period);
  const double shortest =
      std::min(kWindow, std::max(kShortWindow / fastest_rate(model), kFewestReadings * period));
  const double noise = noise_of(dataset), longest = longest_run(dataset);
  for (double window = shortest; window < longest; window *= 2.0)
    if (departure(dataset, window, noise) > kDeparts * noise) return window;
  return shortest;
}

std::optional<double> window_of_drift(const Dataset& dataset, const PlantModel& model) {
  const bool windows = model.baseline.drive == Drive::Force && drifts(dataset, model.baseline);
  return windows ? std::optional(short_window(dataset, model)) : std::nullopt;
}

Choice choose(const Dataset& dataset, const PlantModel& model) {
  Choice out;
  if (model.baseline.drive != Drive::Force) return out;
  out.window = window_of_drift(dataset, model);
  Comparison now = compared(dataset, model, out.window);
  if (out.window) {
    Comparison whole = compared(dataset, model, std::nullopt);
    if (whole.least() < now.least()) now = std::move(whole), out.window.reset();
  }
  if (out.window)
    out.reason = fmt::format(
        "Without a spring small errors add up, so runs are compared in windows of {:.2g} s that start from "
        "the "
        "measured motion.",
        *out.window);
  if (!(excess(now.freed.square, now.evidence) < kHalved * excess(now.calibrated.square, now.evidence)))
    return out;
  Hypothesis& freed = now.freed.hypothesis;
  estimate_uncertainty(freed, now.evidence);
  bool moved = false;
  for (const Unknown& u : freed.unknowns) {
    // One that the data move far without determining it would be wrong as it is: a spring that is not there.
    const bool is_wrong = std::abs(u.theta) > kFar;
    if (u.effect != kBaseline || !(u.std < kDetermined || is_wrong)) continue;
    out.free.emplace_back(uncertain_baseline(Drive::Force)[u.parameter].name);
    moved = moved || std::abs(u.theta) > kMoved;
  }
  if (!moved) out.free.clear();
  if (!out.free.empty())
    out.reason +=
        fmt::format("{}The data want other values of {} than the model has: they are fitted freely.",
                    out.reason.empty() ? "" : " ", fmt::join(out.free, ", "));
  return out;
}

std::optional<ScoredModel> with_numbers_free(const ScoredModel& start, const Evidence& evidence) {
  const PlantModel& model = start.hypothesis.model;
  const std::vector<Unknown>& unknowns = start.hypothesis.unknowns;
  const bool all_free =
      std::ranges::all_of(unknowns, [](const Unknown& u) { return u.effect != kBaseline || is_free(u); });
  if (model.baseline.drive != Drive::Force || all_free) return std::nullopt;
  Hypothesis out = baseline_hypothesis(model, numbers_of(model));
  fit_closely(out, evidence, kIterations);
  return score_model(std::move(out), evidence);
}

std::string names_of_numbers(const Hypothesis& hypothesis) {
  std::vector<std::string_view> names;
  for (const Unknown& u : hypothesis.unknowns)
    if (is_free(u)) names.push_back(uncertain_baseline(hypothesis.model.baseline.drive)[u.parameter].name);
  return fmt::format("{}", fmt::join(names, ", "));
}

void widen_untold(ScoredModel& best, const Evidence& evidence) {
  std::vector<Unknown>& unknowns = best.hypothesis.unknowns;
  if (best.drive() != Drive::Force) return;
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    if (!is_free(unknowns[i]) || !(unknowns[i].std < kDetermined)) continue;
    for (const double other : {unknowns[i].theta - kOther, unknowns[i].theta + kOther})
      if (follows_as_well(best, i, other, evidence)) unknowns[i].std = kOther;
  }
}

bool tells_a_number(const Hypothesis& hypothesis) {
  return std::ranges::none_of(hypothesis.unknowns, is_free) ||
         std::ranges::any_of(hypothesis.unknowns,
                             [](const Unknown& u) { return is_free(u) && u.std < kDetermined; });
}

}  // namespace biopsy::sim::gap
