// A force on plate A as an equation: a sum of coefficients times products of motion and drive. For what the
// library of effects does not have; sim/gap proposes it, and a model file holds it as [term.NAME].
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// What a product is made of. Drive: the voltage that pulls, V, or the force where a force drives, N.
// Memory: how far plate A is from where it was, forgotten with the term's time constant T, m:
// dq/dt = v - q/T, the deflection of a spring in series with a damper. Sine and cosine are of the position,
// with the term's period. A power of the speed has the term's exponent, as of a fluid that thins; below
// kSlowShare of the largest speed seen it is a line.
enum class TermFactor : std::uint8_t {
  Position,
  Speed,
  SpeedSize,
  SpeedSign,
  Drive,
  DriveSize,
  DriveSign,
  Memory,
  SpeedPower,
  PositionSine,
  PositionCosine
};
inline constexpr std::size_t kTermFactors = 11;
inline constexpr std::size_t kMostTermParts = 6;
inline constexpr std::size_t kMostTerms = 4;  // of a model
inline constexpr int kHighestPower = 6;
inline constexpr double kSlowShare = 0.01;

using TermPowers = std::array<std::uint8_t, kTermFactors>;  // by TermFactor

inline int power_of(const TermPowers& powers, TermFactor factor) {
  return powers[static_cast<std::size_t>(factor)];
}

struct TermPart {
  double coefficient = 0.0;  // SI
  TermPowers powers{};

  bool operator==(const TermPart&) const = default;
};

inline bool has_speed_power(const TermPowers& powers) {
  return power_of(powers, TermFactor::SpeedPower) > 0;
}

inline bool repeats_with_position(const TermPowers& powers) {
  return power_of(powers, TermFactor::PositionSine) > 0 || power_of(powers, TermFactor::PositionCosine) > 0;
}

struct TermPoint {
  double x = 0.0, v = 0.0, drive = 0.0, memory = 0.0;  // m, m/s, V or N, m
  double slow = 0.0, exponent = 1.0;                   // m/s, -: of a power of the speed
  double phase = 0.0;                                  // rad, of what repeats with position
};

// Product of the factors, SI.
double product_at(const TermPowers& powers, const TermPoint& at);

// Whether the product jumps where plate A turns, so that it can hold the plate: dry friction.
inline bool acts_at_rest(const TermPowers& powers) {
  return power_of(powers, TermFactor::SpeedSign) > 0 && power_of(powers, TermFactor::Speed) == 0 &&
         power_of(powers, TermFactor::SpeedSize) == 0 && power_of(powers, TermFactor::SpeedPower) == 0;
}

struct TermRange {
  double low = 0.0, high = 0.0;  // SI

  bool operator==(const TermRange&) const = default;
};

// Where a term was seen. Beyond it the force stays as at its edge: an equation that fits a range says nothing
// outside it.
struct TermRanges {
  TermRange x, v, drive, memory;

  TermPoint within(const TermPoint& at) const;
  bool operator==(const TermRanges&) const = default;
};

struct Term {
  std::string name;
  std::vector<TermPart> parts;  // at most kMostTermParts
  TermRanges seen;
  double memory_time = 0.0;  // s; 0 where no part has memory
  double period = 0.0;       // m; 0 where no part repeats with position
  double exponent = 0.0;     // of the power of the speed; 0 where no part has it

  double force(const TermPoint& at) const;  // N, up, without its dry friction
  // N against the motion; nothing where the equation would push along it.
  double dry_friction(const TermPoint& at) const;
  bool has_dry_friction() const;
  Steepness steepest(const Reach& reach) const;
  double largest_force() const;  // N, bound over `seen`

  bool operator==(const Term&) const = default;

 private:
  TermPoint seen_at(const TermPoint& at) const;
  TermPoint sizes_within(double x, double v) const;  // of each variable, where it was seen
};

// Of a period [m], rad/m; 0 without one.
double wave_number(double period);

}  // namespace biopsy::sim
