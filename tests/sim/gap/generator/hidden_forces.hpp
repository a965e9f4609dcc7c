// Hidden forces on plate A and the hidden part of its spring, advanced once a substep.
#pragma once

#include "tests/sim/gap/generator/hidden_physics.hpp"

namespace biopsy::hidden {

// LuGre: bristles that break at the level g(v). Memory solved exactly for constant v.
class Bristle {
 public:
  // Force against v; `level` is the sliding friction now, `stiffness` of the bristle in N/m.
  double advance(double v, double level, double stiffness, double mass, double h);

 private:
  double bend_ = 0.0;
};

class HiddenForces {
 public:
  HiddenForces(const HiddenPhysics& physics, double mass, std::uint64_t seed);

  // N, downwards, on plate A, which the spring or the drive pushes with `drive` (N)
  double resisting(double t, double x, double v, double drive, double h);
  double spring(double stiffness, double deflection, double rate, double h);  // N on top of k * deflection

 private:
  double tissue(double x, double v, double h);
  double shock(double t);

  HiddenPhysics p_;
  double mass_, phase_;
  Dice dice_;
  Bristle slider_, side_, shaft_;
  double bouc_ = 0.0, rope_ = 0.0, maxwell_ = 0.0, collapse_ = 1.0;
  bool punctured_ = false;
  double next_shock_ = 0.0, shock_sign_ = 1.0;
};

}  // namespace biopsy::hidden
