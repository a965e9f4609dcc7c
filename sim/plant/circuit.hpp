// Volts: eq. (2) and the effects on voltage, solved exactly for any length of time while one voltage is asked
// for. Independent of the mechanics.
#pragma once

#include <cmath>

#include "sim/plant/plant_model.hpp"

namespace biopsy::sim {

// Amplifier, stack, and what retained charge screens of the stack's. V
struct Potentials {
  double u_i = 0.0, u_o = 0.0, screened = 0.0;
};

// The voltage that pulls, at the beginning, middle and end of a substep; V. And what stands at its
// end.
struct VoltageProfile {
  double start, half, end;
  Potentials after;
};

inline double acting_voltage(const PlantModel& model, const Potentials& p) {
  const double u = p.u_o - p.screened;
  return model.effects.polarity_asymmetry ? model.effects.polarity_asymmetry->acting(u) : u;
}

// dV/s of the amplifier's output on its way to `asked`.
double amplifier_slope(const PlantModel& model, double u_i, double asked);

// After t, where the amplifier lags, by the effects' equations.
Potentials after(const PlantModel& model, const Potentials& from, double asked, double t);

// What a length of time does to a stack whose amplifier stands still: shares of what was there before it.
struct Fading {
  double u_o = 1.0;       // left of the stack's voltage,
  double screened = 1.0;  // of what is screened,
  double driven = 0.0;    // and what of u_o is screened anew
};
Fading fading(const PlantModel& model, double t);

// Remembers the fading over half of h, the last length asked for: a step's pieces are mostly equally long.
class Circuit {
 public:
  Circuit(const PlantModel& model, double asked, double h)
      : model_(model),
        asked_(asked),
        h_(h),
        still_(!model.effects.amplifier_lag || model.effects.amplifier_lag->instant()),
        half_(still_ ? fading(model, 0.5 * h) : Fading{}) {}

  VoltageProfile over(const Potentials& from, double h) {
    if (!still_) return lagging(from, h);
    if (h != h_) h_ = h, half_ = fading(model_, 0.5 * h);
    const Potentials half = faded(from);
    return profile(from, half, faded(half));
  }

 private:
  Potentials faded(const Potentials& p) const {
    return {p.u_i, p.u_o * half_.u_o, p.screened * half_.screened + p.u_o * half_.driven};
  }
  VoltageProfile lagging(const Potentials& from, double h) const {
    const Potentials half = after(model_, from, asked_, 0.5 * h);
    return profile(from, half, after(model_, half, asked_, 0.5 * h));
  }
  VoltageProfile profile(const Potentials& from, const Potentials& half, const Potentials& end) const {
    return {acting_voltage(model_, from), acting_voltage(model_, half), acting_voltage(model_, end), end};
  }

  const PlantModel& model_;
  double asked_;
  double h_;
  bool still_;
  Fading half_;
};

}  // namespace biopsy::sim
