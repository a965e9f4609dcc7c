#include "sim/gap/find_gap.hpp"

#include <cmath>

#include "sim/gap/conclude.hpp"
#include "sim/gap/fit.hpp"
#include "sim/gap/predict.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr int kIterations = 25;
constexpr double kNotWorse = 1.05;  // held-out mean square

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

// The numbers as the readings alone have them, unless other runs are predicted worse so.
Judged polished(const Judged& best, const Evidence& evidence) {
  Hypothesis fitted = best.hypothesis;
  fit(fitted, evidence, kIterations, kNothingMissing);
  Judged judged = judge(std::move(fitted), evidence);
  return judged.square < kNotWorse * best.square ? judged : best;
}

}  // namespace

FoundGap find_gap(const Dataset& dataset, const PlantModel& model, const SearchOptions& options,
                  const Progress& progress) {
  const Evidence evidence = prepare(dataset, model, options.window, Grain::Fine);
  Hypothesis start = baseline_hypothesis(model, options.free);
  progress("simulating every run with the model as it is");
  const Hypothesis before = as_written(start, evidence);
  const Judged as_given = judge(before, evidence);
  Selection selection{.start = as_given, .best = as_given, .trials = {}, .entrants = {}};
  if (!is_only_noise(mean_square(residual(before.model, evidence, Part::All)), evidence)) {
    progress("fitting the baseline's numbers within their calibration errors");
    carry_over(start, before);
    fit(start, evidence, kIterations);
    selection =
        select(std::move(start), prepare(dataset, model, options.window, Grain::Coarse), evidence, progress);
    progress("the last fit, and standard deviations");
    selection.best = polished(selection.best, evidence);
    estimate_uncertainty(selection.best.hypothesis, evidence);
  }
  return conclude(model, as_given, selection, evidence);
}

}  // namespace biopsy::sim::gap
