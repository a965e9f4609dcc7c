// Random choices that are the seed's own: the same on every machine, in any order of runs.
#pragma once

#include <cstdint>

#include "sim/plant/seeded_noise.hpp"

namespace biopsy::fault_injection {

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : seed_(seed) {}

  double within(double low, double high) { return low + (high - low) * sim::uniform(seed_, next_++); }
  // A whole number in [low, high].
  std::int32_t whole(std::int32_t low, std::int32_t high) {
    return low + static_cast<std::int32_t>(within(0.0, 1.0) * (high - low + 1));
  }
  bool coin() { return within(0.0, 1.0) < 0.5; }
  double either_sign(double low, double high) { return (coin() ? 1.0 : -1.0) * within(low, high); }
  std::uint64_t bits() { return sim::hashed(seed_, next_++); }

 private:
  std::uint64_t seed_, next_ = 0;
};

// The seed of one run of many.
constexpr std::uint64_t seed_of(std::uint64_t seed, std::uint64_t kind, std::uint64_t run) {
  return sim::hashed(sim::hashed(seed, kind), run);
}

}  // namespace biopsy::fault_injection
