#include "robot/live/realtime/tick_clock.hpp"

#include <sys/prctl.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

namespace biopsy::realtime {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kClosest = 4;  // ticks are at least a period / kClosest apart

void sleep_until(std::int64_t due_ns) {
  const timespec due{due_ns / kSecond_ns, due_ns % kSecond_ns};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
  }
}

}  // namespace

std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kSecond_ns + now.tv_nsec;
}

Wake TickSchedule::woke(std::int64_t now_ns) {
  Wake wake{due_ns_, now_ns, 0};
  const std::int64_t earliest_ns = std::max(wake.late_ns(), std::int64_t{0}) + period_ns_ / kClosest;
  const std::int64_t periods = (earliest_ns + period_ns_ - 1) / period_ns_;
  wake.missed = periods - 1;
  due_ns_ += periods * period_ns_;
  return wake;
}

TickClock::TickClock(std::chrono::nanoseconds period)
    : schedule_(monotonic_ns() + period.count(), period.count()) {
  ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
}

Wake TickClock::wait() {
  sleep_until(schedule_.due_ns());
  const Wake wake = schedule_.woke(monotonic_ns());
  missed_ += wake.missed;
  return wake;
}

}  // namespace biopsy::realtime
