// Polarity of the drive: a square wave that keeps the charge balanced, so that the films do not screen it
// (paper II.B).
#pragma once

#include <cstdint>

namespace biopsy::control {

inline constexpr std::uint32_t kHalfPeriod_ticks =
    250;  // 2 Hz, paper IV.B: stable, and no faster than needed

// +1 or -1 at tick n since the drive was enabled.
constexpr int polarity(std::uint32_t tick) {
  return (tick / kHalfPeriod_ticks) % 2 == 0 ? 1 : -1;
}

}  // namespace biopsy::control
