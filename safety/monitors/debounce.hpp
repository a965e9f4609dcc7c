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

// Samples that show a fault, of which `ticks` in a row are one. One that does not show it takes 1 where one
// that does adds `weight`: a fault that comes and goes adds up if it shows in more than one of `weight` + 1
// samples, and no single sound one hides it.
constexpr std::int32_t accumulated(std::int32_t score, bool present, std::int32_t weight,
                                   std::int32_t ticks) {
  return present ? std::min(score + weight, weight * ticks) : std::max(score - 1, 0);
}

// Wrong +2, right -1: a single error decays, a second one soon after trips.
constexpr std::int32_t error_counter(std::int32_t score, bool right) {
  return right ? std::max(score - 1, 0) : std::min(score + kScoreWrong, kScoreMax);
}

}  // namespace biopsy::safety
