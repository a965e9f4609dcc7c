#include "sim/term/term.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace biopsy::sim {
namespace {

double raised(double base, int power) {
  double out = 1.0;
  for (int i = 0; i < power; ++i) out *= base;
  return out;
}

double sign(double value) {
  return value > 0.0 ? 1.0 : value < 0.0 ? -1.0 : 0.0;
}

double size(const TermRange& range) {
  return std::max(std::abs(range.low), std::abs(range.high));
}

// |v|^n, a line up to `slow`.
double speed_power(const TermPoint& at) {
  const double speed = std::abs(at.v);
  return speed == 0.0 ? 0.0 : speed * std::pow(std::max(speed, at.slow), at.exponent - 1.0);
}

double steepest_speed_power(const TermPoint& sizes) {
  const auto slope = [&](double speed) { return std::pow(speed, sizes.exponent - 1.0); };
  return std::max(slope(sizes.slow), sizes.exponent * slope(std::max(sizes.v, sizes.slow)));
}

// The largest size of a product, and of its derivatives to position and speed, where each variable stays
// within these sizes.
struct Bound {
  double product, by_position, by_speed;
};

// `waves`: rad/m.
Bound bound_of(const TermPowers& powers, const TermPoint& sizes, double waves) {
  const auto power = [&](TermFactor factor) { return power_of(powers, factor); };
  const int x = power(TermFactor::Position), v = power(TermFactor::Speed) + power(TermFactor::SpeedSize);
  const double rest = raised(sizes.drive, power(TermFactor::Drive) + power(TermFactor::DriveSize)) *
                      raised(sizes.memory, power(TermFactor::Memory));
  const bool raises = has_speed_power(powers) && sizes.slow > 0.0;
  const double by_power = raises ? speed_power(sizes) : 1.0;
  const double at_x = raised(sizes.x, x), at_v = raised(sizes.v, v);
  Bound out{.product = rest * at_x * at_v * by_power, .by_position = 0.0, .by_speed = 0.0};
  if (x > 0) out.by_position += rest * at_v * by_power * x * raised(sizes.x, x - 1);
  if (repeats_with_position(powers)) out.by_position += out.product * waves;
  if (v > 0) out.by_speed += rest * at_x * by_power * v * raised(sizes.v, v - 1);
  if (raises) out.by_speed += rest * at_x * at_v * steepest_speed_power(sizes);
  return out;
}

}  // namespace

double product_at(const TermPowers& powers, const TermPoint& at) {
  const auto power = [&](TermFactor factor) { return power_of(powers, factor); };
  double out =
      raised(at.x, power(TermFactor::Position)) * raised(at.v, power(TermFactor::Speed)) *
      raised(std::abs(at.v), power(TermFactor::SpeedSize)) * raised(at.drive, power(TermFactor::Drive)) *
      raised(std::abs(at.drive), power(TermFactor::DriveSize)) * raised(at.memory, power(TermFactor::Memory));
  if (power(TermFactor::SpeedSign) > 0) out *= sign(at.v);
  if (power(TermFactor::DriveSign) > 0) out *= sign(at.drive);
  if (has_speed_power(powers)) out *= speed_power(at);
  if (power(TermFactor::PositionSine) > 0) out *= std::sin(at.phase);
  if (power(TermFactor::PositionCosine) > 0) out *= std::cos(at.phase);
  return out;
}

double wave_number(double period) {
  return period > 0.0 ? 2.0 * std::numbers::pi / period : 0.0;
}

TermPoint TermRanges::within(const TermPoint& at) const {
  return {.x = std::clamp(at.x, x.low, x.high),
          .v = std::clamp(at.v, v.low, v.high),
          .drive = std::clamp(at.drive, drive.low, drive.high),
          .memory = std::clamp(at.memory, memory.low, memory.high)};
}

TermPoint Term::seen_at(const TermPoint& at) const {
  TermPoint here = seen.within(at);
  here.slow = kSlowShare * size(seen.v);
  here.exponent = exponent;
  here.phase = wave_number(period) * here.x;
  return here;
}

double Term::force(const TermPoint& at) const {
  const TermPoint here = seen_at(at);
  double sum = 0.0;
  for (const TermPart& part : parts)
    if (!acts_at_rest(part.powers)) sum += part.coefficient * product_at(part.powers, here);
  return sum;
}

double Term::dry_friction(const TermPoint& at) const {
  TermPoint here = seen_at(at);
  here.v =
      1.0;  // only its sign acts; the equation gives the force up, which then opposes the motion if negative
  double sum = 0.0;
  for (const TermPart& part : parts)
    if (acts_at_rest(part.powers)) sum -= part.coefficient * product_at(part.powers, here);
  return std::max(0.0, sum);
}

bool Term::has_dry_friction() const {
  return std::ranges::any_of(parts, [](const TermPart& part) { return acts_at_rest(part.powers); });
}

TermPoint Term::sizes_within(double x, double v) const {
  return {.x = std::min(x, size(seen.x)),
          .v = std::min(v, size(seen.v)),
          .drive = size(seen.drive),
          .memory = size(seen.memory),
          .slow = kSlowShare * size(seen.v),
          .exponent = exponent};
}

Steepness Term::steepest(const Reach& reach) const {
  const TermPoint sizes = sizes_within(reach.x, reach.v);
  Steepness out{.rate = memory_time > 0.0 ? 1.0 / memory_time : 0.0};
  for (const TermPart& part : parts) {
    const Bound bound = bound_of(part.powers, sizes, wave_number(period));
    out.stiffness += std::abs(part.coefficient) * bound.by_position;
    out.damping += std::abs(part.coefficient) * bound.by_speed;
  }
  return out;
}

double Term::largest_force() const {
  const TermPoint sizes = sizes_within(size(seen.x), size(seen.v));
  double sum = 0.0;
  for (const TermPart& part : parts)
    sum += std::abs(part.coefficient) * bound_of(part.powers, sizes, wave_number(period)).product;
  return sum;
}

}  // namespace biopsy::sim
