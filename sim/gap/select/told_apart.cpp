#include "sim/gap/select/told_apart.hpp"

#include <cmath>

namespace biopsy::sim::gap {
namespace {

constexpr double kStandsOut = 4.0;        // standard deviations
constexpr double kIntegratorError = 0.1;  // noises that two integrators may differ by
constexpr double kLeavesNoise = 0.25;     // noises that `a` leaves at most

}  // namespace

double paired_evidence(const ScoredModel& a, const ScoredModel& b, const Evidence& evidence) {
  const double noise = evidence.noise * evidence.noise;
  if (!(excess(a.square, evidence) < kLeavesNoise * kLeavesNoise * noise)) return 0.0;
  if (!(b.square - a.square > kIntegratorError * kIntegratorError * noise)) return 0.0;
  // Of white noise with the predictions as they are: the log likelihood ratio and its standard deviation.
  double ratio = 0.0, apart = 0.0;
  for (std::size_t i = 0; i < a.residual.size(); ++i) {
    ratio += 0.5 * (b.residual[i] * b.residual[i] - a.residual[i] * a.residual[i]) / noise;
    apart += (b.residual[i] - a.residual[i]) * (b.residual[i] - a.residual[i]) / noise;
  }
  ratio *= evidence.independent, apart *= evidence.independent;
  return ratio > kStandsOut * std::sqrt(apart) ? ratio : 0.0;
}

}  // namespace biopsy::sim::gap
