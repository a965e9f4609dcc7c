#include "sim/plant/mechanics.hpp"

#include <algorithm>
#include <cmath>

#include "sim/plant/pouch.hpp"

namespace biopsy::sim {
namespace {

constexpr double kEdge = 1e-12;  // m: what counts as the edge of a play

// Force of the tissue against the needle except dry friction. N, down
double tissue_force(const StepContext& s, const Motion& m) {
  const double x_max = s.state.x_max;
  double force = 0.0;
  for (std::size_t i = 0; i < s.layers; ++i) {
    const TissueLayer& layer = s.model.tissue[i];
    force += layer.surface.push_back(m.x, x_max) + layer.shaft.viscous * layer.shaft.inserted(m.x) * m.v +
             layer.relaxation.push_back(m.x, m.crept[i]);
  }
  const Effects& e = s.model.effects;
  if (e.layer_puncture) force += e.layer_puncture->push_back(m.x, x_max);
  if (e.shaft_friction) force += e.shaft_friction->viscous * e.shaft_friction->inserted(m.x) * m.v;
  if (e.tissue_relaxation) force += e.tissue_relaxation->push_back(m.x, m.crept_lone);
  return force;
}

// Forces of the stage's own effects on plate A, except dry friction. N, down
double stage_force(const StepContext& s, const Motion& m, double since) {
  const Effects& e = s.model.effects;
  double force = 0.0;
  if (e.quadratic_damping) force += e.quadratic_damping->drag(m.v);
  if (const auto& spring = e.hysteretic_spring) {
    const double on_frame = s.model.baseline.drive == Drive::Force ? 1.0 : 1.0 - spring->across;
    force += on_frame * spring->pull(spring->bounded(m.yielded));
  }
  if (e.external_force) force += e.external_force->force;
  if (e.periodic_disturbance)
    force -= e.periodic_disturbance->force * e.periodic_disturbance->wave(s.state.time + since);
  if (e.end_stop) force += e.end_stop->push_back(m.x, m.v);
  if (e.spring_hardening && s.model.baseline.drive == Drive::Force) force += e.spring_hardening->force(m.x);
  return force;
}

void memory_rates(const StepContext& s, const Motion& m, Derivative& d) {
  for (std::size_t i = 0; i < s.layers; ++i) d.dcrept[i] = s.model.tissue[i].relaxation.rate(m.x, m.crept[i]);
  if (!s.has.inner) return;
  const Effects& e = s.model.effects;
  d.dcrept_lone = e.tissue_relaxation ? e.tissue_relaxation->rate(m.x, m.crept_lone) : 0.0;
  d.dpouch = e.pouch_creep ? e.pouch_creep->rate(m.H - s.model.baseline.H_0, m.pouch_crept) : 0.0;
}

// Once the pouches' rate is known: the yielding spring may ride on plate B.
void yield_rate(const StepContext& s, const Motion& m, double v, Derivative& d) {
  const auto& spring = s.model.effects.hysteretic_spring;
  if (!s.has.inner) return;
  const bool stack = s.model.baseline.drive == Drive::Stack;
  d.dyielded = 0.0;
  if (spring)
    d.dyielded = spring->rate(v - (stack ? spring->across * s.model.baseline.n * d.dH : 0.0),
                              spring->bounded(m.yielded));
}

// What set and creep add on top of a pouch, how fast that grows by itself, how much of it per growth of H,
// and the height below which the set does not let the pouch fall.
struct Top {
  double height = 0.0;  // m
  double rate = 0.0;    // m/s
  double per_H = 0.0;
  double floor = 0.0;  // m
};

Top top_of(const StepContext& s, const Motion& m, double since) {
  const Effects& e = s.model.effects;
  const double deflection = m.H - s.model.baseline.H_0;
  Top top;
  if (e.pouch_creep) {
    top.height = m.pouch_crept;
    top.rate = e.pouch_creep->rate(deflection, m.pouch_crept);
  }
  if (const auto& set = e.residual_set) {
    const double largest = set->faded(s.state.memory.largest, since);
    top.floor = s.model.baseline.H_0 + set->floor_share * set->remembered(largest, deflection);
    top.height += set->added(largest, deflection);
    if (largest > deflection) {
      top.per_H = -set->added_share;
      top.rate -= set->added_share * largest / set->time;
    }
  }
  return top;
}

// Upward force of the series spring; sets the pouches' rate. The damper c_k makes the load depend on the
// speed of plate B and that speed on the load: one Newton step from the undamped load solves it, the coupling
// being a few %.
template <bool kTopped>
double spring_force(const StepContext& s, const Motion& m, Instant at, double& dH) {
  const Baseline& b = s.model.baseline;
  Top top;
  if constexpr (kTopped) top = top_of(s, m, at.since);
  double undamped = undamped_spring(s.model, m, s.mass, top.height);
  if constexpr (kTopped) undamped += b.c_k * b.n * top.rate;
  Equilibrium goal = equilibrium(b, pressure(b, at.u), std::max(0.0, undamped) + b.m_B * b.g);
  if (const auto& play = s.model.effects.zipping_hysteresis) {
    const double zipped = std::max(b.H_0, play->zipped(goal.H, s.state.zipped));
    const bool inside = std::abs(goal.H - s.state.zipped) < 0.5 * play->width - kEdge;
    if (inside || zipped == b.H_0) goal.slope *= play->free;  // there the load has no say
    goal.H = play->height(goal.H, zipped);
  }
  if (kTopped && goal.H < top.floor) goal = {top.floor, 0.0};
  const double slope = undamped > 0.0 ? goal.slope : 0.0;
  const double per_H = kTopped ? b.n * (1.0 + top.per_H) : b.n;  // plate B's travel per height of a pouch
  dH = (goal.H - m.H) / (b.tau_h - slope * b.c_k * per_H);
  return std::max(0.0, undamped + b.c_k * per_H * dH);
}

// A stack without set and creep takes the short way.
double spring_force(const StepContext& s, const Motion& m, Instant at, double& dH) {
  return s.has.pouch ? spring_force<true>(s, m, at, dH) : spring_force<false>(s, m, at, dH);
}

// The net force, and the pouches' rate.
double net_force(const StepContext& s, const Motion& m, Instant at, double& dH) {
  const Baseline& b = s.model.baseline;
  double down = b.c_s * m.v + s.inputs.external_force + tissue_force(s, m);
  if (s.has.stage) down += stage_force(s, m, at.since);
  if (b.drive == Drive::Force) return s.inputs.force - b.k * m.x - down;
  return spring_force(s, m, at, dH) - s.mass * b.g - down;
}

}  // namespace

Presence presence(const PlantModel& model) {
  const Effects& e = model.effects;
  return {.dry = e.coulomb_friction || e.stribeck_friction || e.shaft_friction || !model.tissue.empty(),
          .pouch = e.residual_set || e.pouch_creep,
          .stage = e.quadratic_damping || e.hysteretic_spring || e.external_force || e.periodic_disturbance ||
                   e.end_stop || e.spring_hardening,
          .inner = e.tissue_relaxation || e.pouch_creep || e.hysteretic_spring};
}

double friction_bound(const PlantModel& model, double x, double v) {
  const Effects& e = model.effects;
  double bound = 0.0;
  if (e.coulomb_friction) bound += e.coulomb_friction->force;
  if (e.stribeck_friction) bound += e.stribeck_friction->magnitude(v);
  if (e.shaft_friction) bound += e.shaft_friction->coulomb * e.shaft_friction->inserted(x);
  for (const TissueLayer& layer : model.tissue) bound += layer.shaft.coulomb * layer.shaft.inserted(x);
  return bound;
}

double on_top(const PlantModel& model, const Motion& m, double largest) {
  const auto& set = model.effects.residual_set;
  return m.pouch_crept + (set ? set->added(largest, m.H - model.baseline.H_0) : 0.0);
}

double net_force(const StepContext& s, const Motion& m, Instant at) {
  double unused = 0.0;
  return net_force(s, m, at, unused);
}

Derivative rates(const StepContext& s, const Motion& m, Instant at, int direction) {
  Derivative d;
  memory_rates(s, m, d);
  if (direction == 0) {
    if (s.model.baseline.drive == Drive::Stack) spring_force(s, m, at, d.dH);
    yield_rate(s, m, 0.0, d);
    return d;
  }
  d.dx = m.v;
  const double friction = s.has.dry ? direction * friction_bound(s.model, m.x, m.v) : 0.0;
  d.dv = (net_force(s, m, at, d.dH) - friction) / s.mass;
  yield_rate(s, m, m.v, d);
  return d;
}

}  // namespace biopsy::sim
