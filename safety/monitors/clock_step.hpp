// Time between two readings of one clock. Total: any pair of values may arrive.
#pragma once

#include <algorithm>
#include <cstdint>

#include "safety/types/thresholds.hpp"

namespace biopsy::safety {

// Whether `to` is at or behind `from` by less than `most_us`.
constexpr bool is_less_than_after(std::int64_t from_us, std::int64_t to_us, std::int64_t most_us) {
  return to_us >= from_us && most_us > 0 &&
         static_cast<std::uint64_t>(to_us) - static_cast<std::uint64_t>(from_us) <
             static_cast<std::uint64_t>(most_us);
}

// Neither stood still nor went back nor jumped.
constexpr bool is_sound_step(std::int64_t from_us, std::int64_t to_us) {
  return to_us != from_us && is_less_than_after(from_us, to_us, kClockStepMax_us + 1);
}

// `value` + `elapsed` ms, counted no further than `most`.
constexpr std::int32_t later_ms(std::int32_t value, std::int32_t elapsed, std::int32_t most) {
  return std::min(std::clamp(value, 0, most) + std::clamp(elapsed, 0, kElapsedMax_ms), most);
}

}  // namespace biopsy::safety
