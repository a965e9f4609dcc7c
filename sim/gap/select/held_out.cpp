#include "sim/gap/select/held_out.hpp"

#include <algorithm>
#include <utility>

#include "sim/gap/fit/fit.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/select/select.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kNextToNothing = 0.1;  // of the other part's mean square above the noise
constexpr double kFarMore = 4.0;        // times what whole runs show: whole runs are a harder test
constexpr int kCalibrationSteps = 15;

// Mean squares above the noise of the two parts.
struct Shown {
  double least = 0.0, most = 0.0;
};

Shown shown(const PlantModel& model, const Evidence& evidence) {
  const auto left = [&](Part part) {
    const double square = mean_square(residual(model, evidence, part));
    return is_only_noise(square, evidence) ? 0.0 : excess(square, evidence);
  };
  const auto [least, most] = std::minmax({left(Part::Training), left(Part::HeldOut)});
  return {least, most};
}

PlantModel calibrated(Hypothesis start, const Evidence& evidence) {
  fit_closely(start, evidence, kCalibrationSteps);
  return start.model;
}

Evidence all_training(Evidence evidence) {
  for (EvidenceRun& run : evidence.runs) run.training_rows = run.rows.size();
  evidence.training_seconds += std::exchange(evidence.held_out_seconds, 0.0);
  return evidence;
}

}  // namespace

HeldOut choose_held_out(const Hypothesis& start, const Evidence& evidence) {
  HeldOut best = HeldOut::FromSecond;
  if (evidence.roles_given || evidence.runs.size() < 2) return best;
  const Shown usual = shown(calibrated(start, evidence), evidence);
  if (usual.least >= kNextToNothing * usual.most) return best;
  // What the one part lacks a calibration of the other makes up for, and shows it where it is not: all runs
  // are calibrated together to see where it is.
  const PlantModel together = calibrated(start, all_training(evidence));
  double most = 0.0;
  for (const HeldOut one :
       {HeldOut::FromSecond, HeldOut::FromFirst, HeldOut::FromThird, HeldOut::LastThirds}) {
    Evidence split = evidence;
    hold_out(split, one);
    if (split.training_seconds == 0.0 || split.held_out_seconds == 0.0) continue;
    const double least = shown(together, split).least;
    if (least > most * (one == HeldOut::LastThirds ? kFarMore : 1.0)) most = least, best = one;
  }
  return best;
}

}  // namespace biopsy::sim::gap
