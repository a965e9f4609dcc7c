// Volts: eq. (2) and the effects on voltage, solved exactly for any length of time while one voltage is asked
// for. Independent of the mechanics.
#pragma once

#include <cmath>

#include "sim/plant_model.hpp"

namespace biopsy::sim {

// Amplifier, stack, and what retained charge screens of the stack's. V
struct Potentials {
  double u_i = 0.0, u_o = 0.0, screened = 0.0;
};

// The voltage that pulls, at the beginning, middle and end of a passage of time; V. And what stands at its
// end.
struct Passage {
  double start, half, end;
  Potentials after;
};

inline double acting_voltage(const PlantModel& model, const Potentials& p) {
  const double u = p.u_o - p.screened;
  return model.effects.polarity_asymmetry ? model.effects.polarity_asymmetry->acting(u) : u;
}

// dV/s of the amplifier's output on its way to `asked`.
double amplifier_slope(const PlantModel& model, double u_i, double asked);

// After t, by the effects' equations.
Potentials after(const PlantModel& model, const Potentials& from, double asked, double t);

// Remembers the decay over half of h, the last length asked for: a step's pieces are mostly equally long.
class Circuit {
 public:
  Circuit(const PlantModel& model, double asked, double h)
      : model_(model),
        asked_(asked),
        h_(h),
        decay_(half_decay(h)),
        plain_(!model.effects.charge_retention && !model.effects.amplifier_lag &&
               !model.effects.polarity_asymmetry) {}

  Passage over(const Potentials& from, double h) {
    if (!plain_) return with_effects(from, h);
    if (h != h_) {
      h_ = h;
      decay_ = half_decay(h);
    }
    const double half = from.u_o * decay_;
    return {from.u_o, half, half * decay_, {from.u_i, from.u_o * (decay_ * decay_), 0.0}};
  }

 private:
  double half_decay(double h) const { return std::exp(-0.5 * h / model_.baseline.tau); }
  Passage with_effects(const Potentials& from, double h) const {
    const Potentials half = after(model_, from, asked_, 0.5 * h), end = after(model_, half, asked_, 0.5 * h);
    return {acting_voltage(model_, from), acting_voltage(model_, half), acting_voltage(model_, end), end};
  }

  const PlantModel& model_;
  double asked_;
  double h_, decay_;
  bool plain_;
};

}  // namespace biopsy::sim
