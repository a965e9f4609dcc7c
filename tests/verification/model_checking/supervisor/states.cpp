#include "tests/verification/model_checking/supervisor/states.hpp"

#include <algorithm>

namespace biopsy::model_checking {
namespace {

// mode 4 | keys 2 | done 1 | token 1 | step 3 | timer 16 | voltage 24
constexpr unsigned kTimerAt = 24, kStageAt = 40, kTokenAt = 43, kDoneAt = 44, kKeysAt = 45, kModeAt = 47;

std::uint64_t bits(std::uint64_t key, unsigned at, unsigned count) {
  return (key >> at) & ((1ULL << count) - 1);
}

std::int32_t timer_value(const SupervisorState& state) {
  return timer_of(state.mode) == Timer::SinceHeld ? state.ms_since_held : state.ms_in_mode;
}

}  // namespace

std::uint64_t key_of(const SupervisorState& state) {
  const Mode mode = state.mode;
  const std::int32_t ticks = timer_of(mode) == Timer::None ? 0 : timer_value(state);
  const std::int32_t held_mV = remembers_voltage(mode) ? state.held_mV : 0;
  const bool arm_was_down = remembers_arm_key(mode) && state.arm_was_down;
  const bool reset_was_down = remembers_reset_key(mode) && state.reset_was_down;
  return static_cast<std::uint64_t>(std::clamp(held_mV, 0, 0xFF'FFFF)) |
         static_cast<std::uint64_t>(std::clamp(ticks, 0, 0xFFFF)) << kTimerAt |
         std::uint64_t{std::min(state.step, 7U)} << kStageAt | std::uint64_t{state.token != 0} << kTokenAt |
         std::uint64_t{state.step_done} << kDoneAt | std::uint64_t{arm_was_down} << kKeysAt |
         std::uint64_t{reset_was_down} << (kKeysAt + 1) | static_cast<std::uint64_t>(mode) << kModeAt;
}

SupervisorState state_of(std::uint64_t key) {
  SupervisorState state;
  state.session = kSession;
  state.epoch = kEpoch;
  state.seq = kSeq;
  state.arrived_seq = kSeq;  // only compared with the image's, which the inputs choose before and after it
  state.mode = static_cast<Mode>(bits(key, kModeAt, 4));
  state.arm_was_down = bits(key, kKeysAt, 1) != 0;
  state.reset_was_down = bits(key, kKeysAt + 1, 1) != 0;
  state.step_done = bits(key, kDoneAt, 1) != 0;
  state.token = bits(key, kTokenAt, 1) != 0 ? kToken : 0;
  state.step = static_cast<std::uint32_t>(bits(key, kStageAt, 3));
  const auto ticks = static_cast<std::int32_t>(bits(key, kTimerAt, 16));
  if (timer_of(state.mode) == Timer::InMode) state.ms_in_mode = ticks;
  if (timer_of(state.mode) == Timer::SinceHeld) state.ms_since_held = ticks;
  state.held_mV = static_cast<std::int32_t>(bits(key, 0, kTimerAt));
  return state;
}

std::uint64_t without_timer(std::uint64_t key) {
  return key & ~(0xFFFFULL << kTimerAt);
}

bool is_edge_of_time(const SupervisorState& state) {
  const auto near = [&](std::int32_t limit) {
    const std::int32_t timer = timer_value(state);
    return timer == 0 || timer >= limit - 2;
  };
  switch (state.mode) {
    case Mode::Boot:
    case Mode::Hold:
      return near(10'000);
    case Mode::Armed:
      return near(30'000);
    case Mode::Retract:
      return near(300) || (state.ms_in_mode >= 248 && state.ms_in_mode <= 251);
    case Mode::Active:
      return near(101);
    case Mode::Safe:
    case Mode::Ready:
    case Mode::Trip:
    case Mode::Lock:
      break;
  }
  return true;
}

}  // namespace biopsy::model_checking
