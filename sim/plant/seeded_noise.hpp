// Random numbers as a function of seed and counter: independent of the order of calls and of the standard
// library's distributions.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace biopsy::sim {

// splitmix64 (Steele, Lea, Flood 2014), used as a hash of (seed, counter).
constexpr std::uint64_t hashed(std::uint64_t seed, std::uint64_t counter) {
  std::uint64_t z = seed * 0x9E3779B97F4A7C15u + (counter + 1) * 0xD1B54A32D192ED03u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

// In (0, 1), never 0.
constexpr double uniform(std::uint64_t seed, std::uint64_t counter) {
  return (static_cast<double>(hashed(seed, counter) >> 11) + 0.5) * 0x1.0p-53;
}

struct NormalPair {
  double first, second;
};

// Two independent standard normal numbers (Box and Muller 1958).
inline NormalPair normals(std::uint64_t seed, std::uint64_t counter) {
  const double radius = std::sqrt(-2.0 * std::log(uniform(seed, 2 * counter)));
  const double angle = 2.0 * std::numbers::pi * uniform(seed, 2 * counter + 1);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace biopsy::sim
