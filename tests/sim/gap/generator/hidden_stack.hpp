// Hidden electrical and pouch side: from amplifier volts to the height the stack tends to.
#pragma once

#include <array>

#include "tests/sim/gap/generator/hidden_physics.hpp"

namespace biopsy::hidden {

// Own leakage: Cayley's (1 - a) / (1 + a) a substep, error (h / tau)^3 / 12; jumps at the sample as the model
// says.
class HiddenSupply {
 public:
  HiddenSupply(const StageNumbers& numbers, const HiddenPhysics& physics, std::uint64_t seed);
  void command(double volts);                 // a new sample
  void advance(double t, double h);           // between samples
  void zip(double rise);                      // m: a pouch stands so much higher
  double voltage() const { return output_; }  // V, on the stack
  double pressure() const;                    // Pa
  double charge_moved() const { return numbers_.C1 * (applied_ - output_); }  // C, total since the start

 private:
  double limited(double volts) const;

  StageNumbers numbers_;
  HiddenPhysics p_;
  Dice dice_;
  double share_, leak_;  // C1/(C1 + C2) and R (C1 + C2), as the films are zipped
  double wanted_ = 0.0, applied_ = 0.0, output_ = 0.0, trapped_ = 0.0, heat_ = 0.0, next_breakdown_ = 0.0;
};

// State of the films. aim() does not change it; remember() does.
class HiddenFilms {
 public:
  HiddenFilms(const StageNumbers& numbers, const HiddenPhysics& physics);
  double aim(double equilibrium) const;
  void remember(double equilibrium, double height, double h);

 private:
  double floor_, peak_, last_;
  HiddenPhysics p_;
  std::array<double, 2> play_{};
  std::array<double, 3> creep_{};
};

// Smooth play: the follower moves with the leader once the slack is used up, softly (power 8).
double follow(double follower, double from, double to, double radius);

}  // namespace biopsy::hidden
