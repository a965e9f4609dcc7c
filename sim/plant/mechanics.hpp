// Forces and rates of the plant at one instant, for the integrator in plant.cpp.
#pragma once

#include <array>

#include "sim/plant/plant.hpp"

namespace biopsy::sim {

// Groups of terms that a model has: an absent group costs one branch.
struct ActiveTerms {
  bool dry_friction;  // can hold plate A
  bool friction_under_push;
  bool capacitance;   // that changes with the pouches' height
  bool pouch_offset;  // on top of the pouches
  bool load;          // of effects on plate A, besides the tissue's
  bool tissue_load;   // of effects
  bool spring_push;
  bool held;              // pouches, by an effect that follows their equilibrium
  bool pulling;           // adhesion of the films
  bool oil_time;          // that depends on the direction of zipping
  bool remembers;         // what an effect takes over at a substep's end
  bool integrated_state;  // of effects
  bool sensor_filter;
  bool cut_rate;  // something may move faster than a step resolves
  bool term, term_memory;
};
ActiveTerms active_terms(const PlantModel& model);

// What an evaluation needs besides the motion: as it was at the beginning of the substep.
struct StepContext {
  const PlantModel& model;
  const PlantInputs& inputs;
  const PlantState& state;
  const ActiveTerms has;
  const std::size_t layers;  // of tissue that the needle can touch within this substep
  const double mass;         // kg, of plate A

  // States besides H, x and v change within this substep.
  bool evolves() const { return has.integrated_state || has.term_memory || layers > 0; }
};

// A moment within the substep: the voltage that pulls (V), and the time since the substep began (s).
struct Instant {
  double u, since;
};

// Derivatives of H, x and v, and of what else evolves.
struct Derivative {
  double dH = 0.0, dx = 0.0, dv = 0.0;
  IntegratedStates integrated;            // only where the model has any
  std::array<double, kMaxLayers> dcrept;  // only for the layers within reach
  std::array<double, kMostTerms> dfaded;  // only where a term has memory
};

// direction: +1 or -1 while sliding (friction opposes it), 0 while stuck.
Derivative rates(const StepContext& s, const Motion& m, Instant at, int direction);

// Net force on plate A without dry friction, N, up; and the rate of the pouches there, m/s.
struct Force {
  double net = 0.0, dH = 0.0;
};
Force net_force(const StepContext& s, const Motion& m, Instant at);

// As rates() of a plate A that is stuck, the rate of the pouches being known.
Derivative stuck_rates(const StepContext& s, const Motion& m, double dH);

// Dry friction available in this motion, plate A having speed v. N
double friction_bound(const StepContext& s, const Motion& m, double v, Instant at);

// What the effects add to one pouch, `since` (s) after their states were remembered.
PouchOffset pouch_offset(const PlantModel& model, const Motion& m, const RememberedStates& remembered,
                         double since);

// The voltage that the films' adhesion leaves of the one on the stack. V, its size counts
inline double pulling_voltage(const PlantModel& model, const Motion& m, const RememberedStates& remembered,
                              double u) {
  for_each_present(model.effects, m.integrated, remembered,
                   [&]<class E>(const E& effect, const auto&... own) {
                     if constexpr (requires { &E::pulling; }) u = effect.pulling(u, own...);
                   });
  return u;
}

// Time in which the oil lets a pouch move on, `gap` (m) below where it goes. s
inline double oil_time(const PlantModel& model, double gap) {
  double time = model.baseline.tau_h;
  for_each_present(model.effects, [&]<class E>(const E& effect) {
    if constexpr (requires { &E::oil_time_ratio; }) time *= effect.oil_time_ratio(gap);
  });
  return time;
}

// The series spring's push on a plate A of that mass (kg), without the part of its damper that depends on
// plate B's speed; `offset` (m) is on top of each pouch. N, up
inline double undamped_spring(const PlantModel& model, const ActiveTerms& has, const Motion& m,
                              const RememberedStates& remembered, double mass, double offset) {
  const Baseline& b = model.baseline;
  const double stretch = b.n * (m.H - b.H_0 + offset) - m.x;
  double push = mass * b.g + b.k * stretch - b.c_k * m.v;
  if (!has.spring_push) return push;
  for_each_present(model.effects, m.integrated, remembered,
                   [&]<class E>(const E& effect, const auto&... own) {
                     if constexpr (requires { &E::spring_push; })
                       push += effect.spring_push({stretch, true}, own...);
                   });
  return push;
}

}  // namespace biopsy::sim
