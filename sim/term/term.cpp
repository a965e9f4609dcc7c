#include "sim/term/term.hpp"

#include <algorithm>
#include <cmath>

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

// The largest size of a product, and of its derivatives to position and speed, where each variable stays
// within these sizes.
struct Bound {
  double product, by_position, by_speed;
};

Bound bound_of(const TermPowers& powers, const TermPoint& sizes) {
  const auto power = [&](TermFactor factor) { return power_of(powers, factor); };
  const int x = power(TermFactor::Position), v = power(TermFactor::Speed) + power(TermFactor::SpeedSize);
  const double rest = raised(sizes.drive, power(TermFactor::Drive) + power(TermFactor::DriveSize)) *
                      raised(sizes.memory, power(TermFactor::Memory));
  const double at_x = raised(sizes.x, x), at_v = raised(sizes.v, v);
  return {.product = rest * at_x * at_v,
          .by_position = x == 0 ? 0.0 : rest * at_v * x * raised(sizes.x, x - 1),
          .by_speed = v == 0 ? 0.0 : rest * at_x * v * raised(sizes.v, v - 1)};
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
  return out;
}

TermPoint TermRanges::within(const TermPoint& at) const {
  return {.x = std::clamp(at.x, x.low, x.high),
          .v = std::clamp(at.v, v.low, v.high),
          .drive = std::clamp(at.drive, drive.low, drive.high),
          .memory = std::clamp(at.memory, memory.low, memory.high)};
}

double Term::force(const TermPoint& at) const {
  const TermPoint here = seen.within(at);
  double sum = 0.0;
  for (const TermPart& part : parts)
    if (!acts_at_rest(part.powers)) sum += part.coefficient * product_at(part.powers, here);
  return sum;
}

double Term::dry_friction(const TermPoint& at) const {
  TermPoint here = seen.within(at);
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

Steepness Term::steepest(const Reach& reach) const {
  const TermPoint sizes{.x = std::min(reach.x, size(seen.x)),
                        .v = std::min(reach.v, size(seen.v)),
                        .drive = size(seen.drive),
                        .memory = size(seen.memory)};
  Steepness out{.rate = memory_time > 0.0 ? 1.0 / memory_time : 0.0};
  for (const TermPart& part : parts) {
    const Bound bound = bound_of(part.powers, sizes);
    out.stiffness += std::abs(part.coefficient) * bound.by_position;
    out.damping += std::abs(part.coefficient) * bound.by_speed;
  }
  return out;
}

double Term::largest_force() const {
  double sum = 0.0;
  for (const TermPart& part : parts)
    sum += std::abs(part.coefficient) *
           bound_of(part.powers, {size(seen.x), size(seen.v), size(seen.drive), size(seen.memory)}).product;
  return sum;
}

}  // namespace biopsy::sim
