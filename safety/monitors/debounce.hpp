// Counters of the monitors, bounded so that the reachable states are finite.
#pragma once

#include <algorithm>
#include <cstdint>

#include "safety/types/hazards.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::safety {

constexpr HazardSet when(bool condition, Hazard hazard) {
  return condition ? bit(hazard) : HazardSet{0};
}

// Consecutive ticks for which a condition was present.
constexpr std::int32_t debounced(std::int32_t count, bool present, std::int32_t most) {
  return present ? std::min(count + 1, most) : 0;
}

// Wrong +2, right -1: a single error decays, a second one soon after trips.
constexpr std::int32_t error_counter(std::int32_t score, bool right) {
  return right ? std::max(score - 1, 0) : std::min(score + kScoreWrong, kScoreMax);
}

}  // namespace biopsy::safety
