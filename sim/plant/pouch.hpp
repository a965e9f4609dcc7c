// Equilibrium of one pouch, eq. (18)-(21).
#pragma once

#include <cmath>
#include <numbers>

#include "sim/plant/plant_model.hpp"

namespace biopsy::sim {

// eq. (21): pressure of the films' attraction. Pa
inline double pressure(const Baseline& b, double u_o) {
  return b.eps_film * kVacuumPermittivity * u_o * u_o / (2.0 * b.d_film * b.d_film);
}

// Height at which pressure P carries load F: S = F/(L0 P) and eq. (18) solved for H. Written as a/(sqrt(S^2 +
// a) + S) because the difference sqrt(S^2 + a) - S cancels to nothing at low voltage, and multiplied through
// by L0 P.
inline Equilibrium equilibrium(const Baseline& b, double P, double F) {
  const double stiffness = b.L0 * P;  // N/m
  const double a = std::numbers::pi * b.V0 / b.L0;
  const double root = std::sqrt(F * F + a * stiffness * stiffness);
  if (root <= 0.0) return {b.H_0, 0.0};
  const double H = (2.0 / std::numbers::pi) * a * stiffness / (root + F);
  if (H <= b.H_0) return {b.H_0, 0.0};
  return {H, -H / root};
}

}  // namespace biopsy::sim
