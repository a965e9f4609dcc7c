// Forces and rates of the plant at one instant: what the integrator in plant.cpp asks for.
#pragma once

#include <array>

#include "sim/plant/plant.hpp"

namespace biopsy::sim {

// Which groups of effects a model has: an absent group costs one branch.
struct Presence {
  bool dry;    // friction that can hold plate A
  bool pouch;  // set or creep on top of the pouches
  bool stage;  // further forces on plate A
  bool inner;  // motion behind the plates: creep, a yielding spring
};
Presence presence(const PlantModel& model);

// What an evaluation needs besides the motion itself: all of it as it was when the substep of time began.
struct StepContext {
  const PlantModel& model;
  const PlantInputs& inputs;
  const PlantState& state;
  const Presence has;
  const std::size_t layers;  // of tissue that the needle can touch within this substep
  const double mass;         // kg, of plate A
};

// A moment within the substep: the voltage that pulls (V), and the time since the substep began (s).
struct Instant {
  double u, since;
};

struct Derivative {
  double dH = 0.0, dx = 0.0, dv = 0.0;
  double dpouch, dyielded, dcrept_lone;   // only where the model has inner motion
  std::array<double, kMaxLayers> dcrept;  // only for the layers within reach
};

// direction: +1 or -1 while sliding (friction opposes it), 0 while stuck.
Derivative rates(const StepContext& s, const Motion& m, Instant at, int direction);

// Net force on plate A without dry friction. N, up
double net_force(const StepContext& s, const Motion& m, Instant at);

// Dry friction available at this position and speed. N
double friction_bound(const PlantModel& model, double x, double v);

// What set and creep put on top of one pouch, `largest` being the set's memory. m
double on_top(const PlantModel& model, const Motion& m, double largest);

// The spring's push on a plate A of that mass (kg), without the part of its damper that depends on plate B's
// speed. N
inline double undamped_spring(const PlantModel& model, const Motion& m, double mass, double on_top) {
  const Baseline& b = model.baseline;
  const double stretch = b.n * (m.H - b.H_0 + on_top) - m.x;
  double push = mass * b.g + b.k * stretch - b.c_k * m.v;
  if (const auto& cubic = model.effects.spring_hardening) push += cubic->force(stretch);
  if (const auto& bouc = model.effects.hysteretic_spring)
    push -= bouc->across * bouc->pull(bouc->bounded(m.yielded));
  return push;
}

}  // namespace biopsy::sim
