#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/plant/plant.hpp"

namespace biopsy::sim {
namespace {

// Steepest stiffness (N/m) and damping (N s/m) that act on plate A.
struct Steepest {
  double stiffness = 0.0, damping = 0.0;

  void add(const LayerPuncture& p) {
    const double highest = std::max(p.force, p.cutting);
    stiffness += std::max({2.0 * p.force / p.deflection, std::abs(p.force - p.cutting) / p.collapse,
                           2.0 * highest / p.deflection});
  }
  void add(const ShaftFriction& f, double x_reach) { damping += f.viscous * f.inserted(x_reach); }
};

Steepest steepest(const PlantModel& model, double x_reach, double v_reach) {
  const Baseline& b = model.baseline;
  const Effects& e = model.effects;
  Steepest sum{b.k, b.c_s + (b.drive == Drive::Stack ? b.c_k : 0.0)};
  if (e.spring_hardening) sum.stiffness += std::abs(e.spring_hardening->stiffness(x_reach));
  if (e.hysteretic_spring) sum.stiffness += e.hysteretic_spring->stiffness;
  if (e.quadratic_damping) sum.damping += 2.0 * e.quadratic_damping->coefficient * v_reach;
  if (e.end_stop) {
    sum.stiffness += e.end_stop->stiffness;
    sum.damping += e.end_stop->damping;
  }
  if (e.layer_puncture) sum.add(*e.layer_puncture);
  if (e.shaft_friction) sum.add(*e.shaft_friction, x_reach);
  if (e.tissue_relaxation) sum.stiffness += e.tissue_relaxation->stiffness;
  for (const TissueLayer& layer : model.tissue) {
    sum.add(layer.surface);
    sum.add(layer.shaft, x_reach);
    sum.stiffness += layer.relaxation.stiffness;
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
  return (1.0 + slope * b.k * b.n) / b.tau_h;
}

}  // namespace

double fastest_rate(const PlantModel& model, double x_reach, double v_reach) {
  const Effects& e = model.effects;
  const Steepest on_A = steepest(model, x_reach, v_reach);
  const double mass = model.mass_A();
  double rate = on_A.damping / mass + std::sqrt(on_A.stiffness / mass);
  if (model.baseline.drive == Drive::Stack) rate = std::max(rate, oil_rate(model));
  if (e.pouch_creep) rate = std::max(rate, 1.0 / e.pouch_creep->time);
  if (e.tissue_relaxation) rate = std::max(rate, 1.0 / e.tissue_relaxation->time);
  for (const TissueLayer& layer : model.tissue) rate = std::max(rate, 1.0 / layer.relaxation.time);
  if (e.periodic_disturbance)
    rate = std::max(rate, 2.0 * std::numbers::pi * e.periodic_disturbance->frequency);
  return rate;
}

}  // namespace biopsy::sim
