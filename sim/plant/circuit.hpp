// Voltages: eq. (2) and the effects on voltage, solved exactly over any length of time at a constant command
// and a constant capacitance, which alone depends on the mechanics.
#pragma once

#include <optional>

#include "sim/plant/plant_model.hpp"

namespace biopsy::sim {

// Amplifier's output, stack, and what retained charge screens of the stack's. V
struct CircuitState {
  double u_i = 0.0, u_o = 0.0, screened = 0.0;
};

// The voltage that pulls at the start, the middle and the end of a substep, V; and the circuit at its end.
struct VoltageProfile {
  double start, half, end;
  CircuitState after;
};

// Voltage commanded of the amplifier for a requested one. V
inline double commanded_voltage(const PlantModel& model, double requested) {
  double u = requested;
  for_each_present(model.effects, [&]<class E>(const E& effect) {
    if constexpr (requires { &E::limited; }) u = effect.limited(u);
  });
  return u;
}

inline double acting_voltage(const PlantModel& model, const CircuitState& c) {
  double u = c.u_o - c.screened;
  for_each_present(model.effects, [&]<class E>(const E& effect) {
    if constexpr (requires { &E::acting; }) u = effect.acting(u);
  });
  return u;
}

// Of the effect that has one; instant without.
inline AmplifierDynamics amplifier_dynamics(const Effects& effects) {
  AmplifierDynamics dynamics;
  for_each_present(effects, [&]<class E>(const E& effect) {
    if constexpr (requires { &E::amplifier; }) dynamics = effect.amplifier();
  });
  return dynamics;
}

// (C1 + C2) over its value at H_0, of the effect that has one; 1 without. The baseline's K is divided by it,
// its tau multiplied. H: height of a pouch, m.
inline double capacitance_ratio(const PlantModel& model, double H) {
  double ratio = 1.0;
  for_each_present(model.effects, [&]<class E>(const E& effect) {
    if constexpr (requires { &E::capacitance_ratio; })
      ratio = effect.capacitance_ratio(H - model.baseline.H_0);
  });
  return ratio;
}

// dV/s of the amplifier's output on its way to u_command.
double amplifier_slope(const AmplifierDynamics& amplifier, double u_i, double u_command);

// The circuit over the substeps of steps with one command. While the amplifier stands still, the decay over
// half of the last length is kept: substeps are mostly equally long.
class Circuit {
 public:
  explicit Circuit(const PlantModel& model);

  bool instant() const { return instant_; }
  void command(double u_command) { u_command_ = u_command; }
  // The stack's C1 + C2 is `ratio` of the baseline's from here on.
  void set_capacitance(double ratio) { K_ = K_0_ / ratio, tau_ = tau_0_ * ratio, h_ = 0.0; }

  // `model`: the one that it was made of.
  VoltageProfile over(const PlantModel& model, const CircuitState& from, double h) {
    if (!instant_) return lagging(model, from, h);
    if (h != h_) h_ = h, half_ = decay(0.5 * h);
    const CircuitState half = decayed(from);
    return profile(model, from, half, decayed(half));
  }

 private:
  // Factors on what was there at the beginning of a time, the amplifier standing still.
  struct Decay {
    double u_o = 1.0, screened = 1.0;
    double charging = 0.0;  // of u_o, onto the screened voltage
  };
  // The amplifier's output changes by u_i' = slope + missing/lag exp(-t/lag).
  struct Ramp {
    double slope = 0.0;    // V/s
    double missing = 0.0;  // V
    double lag = 1.0;      // s
  };

  Decay decay(double t) const;
  CircuitState decayed(const CircuitState& c) const {
    return {c.u_i, c.u_o * half_.u_o, c.screened * half_.screened + c.u_o * half_.charging};
  }
  CircuitState ramped(const CircuitState& c, const Ramp& ramp, double t) const;
  CircuitState after(const CircuitState& from, double t) const;  // where the amplifier lags
  VoltageProfile lagging(const PlantModel& model, const CircuitState& from, double h) const {
    const CircuitState half = after(from, 0.5 * h);
    return profile(model, from, half, after(half, 0.5 * h));
  }
  static VoltageProfile profile(const PlantModel& model, const CircuitState& from, const CircuitState& half,
                                const CircuitState& end) {
    return {acting_voltage(model, from), acting_voltage(model, half), acting_voltage(model, end), end};
  }

  AmplifierDynamics amplifier_;
  std::optional<Screening> screening_;
  bool instant_;
  double K_0_, tau_0_;  // of the baseline
  double K_ = K_0_, tau_ = tau_0_;
  double u_command_ = 0.0;
  double h_ = 0.0;  // none yet
  Decay half_;
};

}  // namespace biopsy::sim
