#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/plant/mechanics.hpp"
#include "sim/plant/plant.hpp"

namespace biopsy::sim {
namespace {

Steepness& operator+=(Steepness& sum, const Steepness& one) {
  sum.stiffness += one.stiffness;
  sum.damping += one.damping;
  sum.rate = std::max(sum.rate, one.rate);
  return sum;
}

// Steepest stiffness (N/m) and damping (N s/m) that act on plate A, and the fastest rate of what moves by
// itself.
Steepness steepest(const PlantModel& model, const Reach& reach) {
  const Baseline& b = model.baseline;
  Steepness sum{b.k, b.c_s + (b.drive == Drive::Stack ? b.c_k : 0.0)};
  for_each_present(model.effects, [&]<class E>(const E& effect) {
    if constexpr (requires { &E::steepest; }) sum += effect.steepest(reach);
  });
  for (const Term& term : model.terms) sum += term.steepest(reach);
  for (const TissueLayer& layer : model.tissue) {
    sum += layer.surface.steepest(reach);
    sum += layer.shaft.steepest(reach);
    sum += layer.relaxation.steepest(reach);
  }
  return sum;
}

// Oil flow, sped up by the load that the spring adds as the pouches rise: |dH/dF| of the equilibrium is at
// most 0.300 of the greatest height over the load (at P L0 sqrt(pi V0/L0) = 1.27 F).
double oil_rate(const PlantModel& model) {
  const Baseline& b = model.baseline;
  const double load = (model.mass_A() + b.m_B) * b.g;
  const double highest = 2.0 / std::numbers::pi * std::sqrt(std::numbers::pi * b.V0 / b.L0);
  const double slope = load > 0.0 ? 0.300 * highest / load : 0.0;
  return (1.0 + slope * b.k * b.n) / std::min(oil_time(model, 1.0), oil_time(model, -1.0));
}

}  // namespace

double fastest_rate(const PlantModel& model, double x_reach, double v_reach) {
  const Steepness on_A = steepest(model, {x_reach, v_reach});
  const double mass = model.mass_A();
  const double rate = std::max(on_A.rate, on_A.damping / mass + std::sqrt(on_A.stiffness / mass));
  return model.baseline.drive == Drive::Stack ? std::max(rate, oil_rate(model)) : rate;
}

}  // namespace biopsy::sim
