// A supervisor's state as far as it decides anything. What its key leaves out is checked at every step
// to decide nothing (equivalent_step.hpp), not assumed.
#pragma once

#include <cstdint>

#include "safety/supervisor.hpp"

namespace biopsy::model_checking {

using safety::SupervisorState;

// Canonical values. A token only matters by what it is larger than or equal to: one below, one above.
inline constexpr std::uint32_t kSession = 5, kEpoch = 10, kSeq = 1'000;
inline constexpr std::uint32_t kOldToken = 1, kToken = 2, kNewToken = 3;

// The timer that decides in a mode; every other is forgotten there. Both count each tick: no time is skipped.
enum class Timer : std::uint8_t { None, InMode, SinceHeld };
constexpr Timer timer_of(Mode mode) {
  switch (mode) {
    case Mode::Boot:
    case Mode::Armed:
    case Mode::Hold:
    case Mode::Retract:
      return Timer::InMode;
    case Mode::Active:
      return Timer::SinceHeld;
    case Mode::Safe:
    case Mode::Ready:
    case Mode::Trip:
    case Mode::Lock:
      break;
  }
  return Timer::None;
}
constexpr bool remembers_voltage(Mode mode) {
  return mode == Mode::Hold || mode == Mode::Retract;
}

// Where a key on the device was decides only where its edge can be followed; its next position is an input.
constexpr bool remembers_arm_key(Mode mode) {
  return mode == Mode::Ready;
}
// From these the next tick may be in Ready; in every other mode an equivalent shows that the key decides
// nothing.
constexpr bool can_lead_to_ready(Mode mode) {
  return mode == Mode::Safe || mode == Mode::Ready || mode == Mode::Armed;
}
constexpr bool remembers_reset_key(Mode mode) {
  return mode == Mode::Trip;
}

// What a state decides by, in one number of 51 bits; the canonical state of a number; the number without
// timer.
std::uint64_t key_of(const SupervisorState& state);
SupervisorState state_of(std::uint64_t key);
std::uint64_t without_timer(std::uint64_t key);

// The times at which every input is tried: the first tick, and the last two before a time runs out (a time is
// compared in one place, so nothing changes between).
bool is_edge_of_time(const SupervisorState& state);

}  // namespace biopsy::model_checking
