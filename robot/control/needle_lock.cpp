#include "robot/control/needle_lock.hpp"

#include <algorithm>

namespace biopsy::control {
namespace {

constexpr Volts kAsBefore{1.0};  // the permit's envelope is in whole millivolts

}  // namespace

NeedleLock lock_in_hold(NeedleLock lock, bool may, bool wanted, Volts amplitude) {
  if (!may || (!lock.on && !wanted)) return {};
  if (!lock.on) lock = {.on = true, .carried = amplitude};
  ++lock.ticks;
  lock.lifting = lock.carrying = 0;
  lock.lifted = false;
  return lock;
}

Volts unloaded(const NeedleLock& lock, Volts amplitude) {
  if (lock.ticks <= kGrip_ticks) return amplitude;
  const std::uint32_t gone = std::min(lock.ticks - kGrip_ticks, kUnload_ticks);
  const double left = 1.0 - static_cast<double>(gone) / kUnload_ticks;
  return std::min(amplitude, left * lock.carried);
}

NeedleLock lift(NeedleLock lock, Volts& amplitude, Volts envelope) {
  const Volts stride = (1.0 / kUnload_ticks) * lock.carried;
  const Volts past = lock.carried + kPast;
  if (lock.lifted)
    amplitude = std::min({std::max(lock.carried, amplitude - stride), envelope});
  else
    amplitude = std::min({past, envelope, amplitude + stride});
  ++lock.lifting;
  lock.lifted = lock.lifted || amplitude + kAsBefore >= past || lock.lifting >= kLiftMax_ticks - kCarry_ticks;
  const bool back = lock.lifted && amplitude <= lock.carried + kAsBefore;
  lock.carrying = back ? lock.carrying + 1 : 0;
  if (lock.carrying >= kCarry_ticks || lock.lifting >= kLiftMax_ticks) return {};
  return lock;
}

}  // namespace biopsy::control
