// Units as types: a length cannot be passed where a voltage is wanted. Numbers leave these types only at
// edges (files, wires, screens), where the unit moves into the name (`depth_mm`).
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <compare>
#include <cstdint>
#include <limits>

namespace biopsy {

template <class Unit>
struct Quantity {
  double value = 0.0;

  constexpr Quantity() = default;
  constexpr explicit Quantity(double number) : value(number) {}
  constexpr auto operator<=>(const Quantity&) const = default;
  constexpr Quantity operator-() const { return Quantity(-value); }
  constexpr Quantity& operator+=(Quantity other) { return value += other.value, *this; }
  constexpr Quantity& operator-=(Quantity other) { return value -= other.value, *this; }
  friend constexpr Quantity operator+(Quantity a, Quantity b) { return Quantity(a.value + b.value); }
  friend constexpr Quantity operator-(Quantity a, Quantity b) { return Quantity(a.value - b.value); }
  friend constexpr Quantity operator*(Quantity a, double k) { return Quantity(a.value * k); }
  friend constexpr Quantity operator*(double k, Quantity a) { return Quantity(a.value * k); }
  friend constexpr Quantity operator/(Quantity a, double k) { return Quantity(a.value / k); }
  friend constexpr double operator/(Quantity a, Quantity b) { return a.value / b.value; }
};

using Millimetres = Quantity<struct MillimetreUnit>;
using MillimetresPerSecond = Quantity<struct MillimetrePerSecondUnit>;
using Volts = Quantity<struct VoltUnit>;
using Grams = Quantity<struct GramUnit>;
using Seconds = std::chrono::duration<double>;

constexpr Millimetres operator*(MillimetresPerSecond speed, Seconds time) {
  return Millimetres(speed.value * time.count());
}

// The control period T of the whole robot: one measurement, one permit, one voltage.
inline constexpr std::chrono::milliseconds kTick{1};

// The nearest integer; what is larger than any of them, as the largest: a wrap would make 4.3 km of 4 mm.
inline std::int32_t to_integer(double number) {
  constexpr double kLeast = std::numeric_limits<std::int32_t>::min(),
                   kMost = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::lround(std::clamp(number, kLeast, kMost)));
}

// Safety and wires count in integers: micrometres and millivolts.
inline std::int32_t to_um(Millimetres length) {
  return to_integer(length.value * 1e3);
}
inline std::int32_t to_mV(Volts voltage) {
  return to_integer(voltage.value * 1e3);
}
constexpr Millimetres from_um(std::int32_t um) {
  return Millimetres(um * 1e-3);
}
constexpr Volts from_mV(std::int32_t mV) {
  return Volts(mV * 1e-3);
}

}  // namespace biopsy
