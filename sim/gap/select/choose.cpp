#include "sim/gap/select/choose.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/gap/fit/fit.hpp"
#include "sim/gap/residual/predict.hpp"
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
constexpr double kHalved = 0.5;          // excess square
constexpr int kIterations = 20;

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

}  // namespace

double short_window(const Dataset& dataset, const PlantModel& model) {
  double period = 0.0;
  for (const RecordedRun& run : dataset.runs) period = std::max(period, run.period);
  return std::min(kWindow, std::max(kShortWindow / fastest_rate(model), kFewestReadings * period));
}

std::optional<double> window_of_drift(const Dataset& dataset, const PlantModel& model) {
  const bool windows = model.baseline.drive == Drive::Force && drifts(dataset, model.baseline);
  return windows ? std::optional(short_window(dataset, model)) : std::nullopt;
}

Choice choose(const Dataset& dataset, const PlantModel& model) {
  Choice out;
  if (model.baseline.drive != Drive::Force) return out;
  if ((out.window = window_of_drift(dataset, model))) {
    out.reason = fmt::format(
        "Without a spring small errors add up, so runs are compared in windows of {:.2g} s that start from "
        "the "
        "measured motion.",
        *out.window);
  }
  const Evidence evidence = prepare(dataset, model, out.window, Sampling::Coarse);
  Hypothesis calibrated = baseline_hypothesis(model, {});
  std::vector<std::string> names;
  for (const UncertainParameter& p : uncertain_baseline(Drive::Force))
    if (model.baseline.*(p.member) > 0.0) names.emplace_back(p.name);
  Hypothesis freed = baseline_hypothesis(model, names);
  fit(calibrated, evidence, kIterations);
  fit(freed, evidence, kIterations);
  const double kept = score_model(calibrated, evidence).square, best = score_model(freed, evidence).square;
  if (!(excess(best, evidence) < kHalved * excess(kept, evidence))) return out;
  estimate_uncertainty(freed, evidence);
  bool moved = false;
  for (const Unknown& u : freed.unknowns) {
    if (u.effect != kBaseline || !(u.std < kDetermined)) continue;
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

}  // namespace biopsy::sim::gap
