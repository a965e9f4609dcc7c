// The needle locked by the stage's brake for an image, and no voltage meanwhile: no edge of the square wave
// falls into the acquisition, and nothing drifts with the charge that leaks.
//
// Brake on; once it grips, the amplitude falls to 0 V. To go on, the amplitude rises past what carried the
// needle before and comes back to it: the films pull less on the way up than on the way down, and the needle
// was held on the way down. Only when the stack pulls as it did is the needle let go.
#pragma once

#include <cstdint>

#include "robot/common/units.hpp"

namespace biopsy::control {

inline constexpr std::uint32_t kGrip_ticks = 100;      // longer than any brake of this kind needs to grip
inline constexpr std::uint32_t kUnload_ticks = 250;    // as long as a C1 ramp
inline constexpr std::uint32_t kCarry_ticks = 500;     // a period of the square wave: retained charge settles
inline constexpr Volts kPast{1100.0};                  // within what the supervisor allows beyond it
inline constexpr std::uint32_t kLiftMax_ticks = 5000;  // whatever the envelope allows by then must do

struct NeedleLock {
  bool on = false;
  Volts carried;                            // amplitude that held the needle before
  std::uint32_t ticks = 0;                  // since it was locked
  std::uint32_t lifting = 0, carrying = 0;  // ticks since the amplitude may rise again, and is back
  bool lifted = false;                      // past what carried the needle
};

// In a hold: whether the needle is locked in this tick, and the amplitude that is wanted. `may`: the permit
// allows it; `wanted`: the operator asks for an image.
NeedleLock lock_in_hold(NeedleLock lock, bool may, bool wanted, Volts amplitude);
Volts unloaded(const NeedleLock& lock, Volts amplitude);

// While the amplitude may rise up to `envelope`: the next one, and whether the needle is let go.
NeedleLock lift(NeedleLock lock, Volts& amplitude, Volts envelope);

}  // namespace biopsy::control
