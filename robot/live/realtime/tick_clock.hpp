// Periodic ticks of a real-time process, absolute on CLOCK_MONOTONIC.
#pragma once

#include <chrono>
#include <cstdint>

namespace biopsy::realtime {

std::int64_t monotonic_ns();  // CLOCK_MONOTONIC

// One wake of the clock.
struct Wake {
  std::int64_t due_ns = 0, woke_ns = 0;
  std::int64_t missed = 0;  // later periods without a tick of their own, lost in the stall

  std::int64_t late_ns() const { return woke_ns - due_ns; }
};

// When ticks are due. Arithmetic only, so that a test can stall it.
//
// Ticks lie on a grid of whole periods. A late tick is done at once; the next is the first grid point at
// least a quarter of a period after it. So a stall is followed by one late tick and no burst, and two ticks
// never come so close that a clock in microseconds could call it no time at all.
class TickSchedule {
 public:
  TickSchedule(std::int64_t first_ns, std::int64_t period_ns) : due_ns_(first_ns), period_ns_(period_ns) {}

  std::int64_t due_ns() const { return due_ns_; }
  Wake woke(std::int64_t now_ns);

 private:
  std::int64_t due_ns_, period_ns_;
};

// Sleeps from tick to tick on the thread that made it, with a timer slack of 1 ns (the default of 50 us is
// for batteries). Neither allocates nor throws after construction.
class TickClock {
 public:
  explicit TickClock(std::chrono::nanoseconds period);  // first tick one period from now

  Wake wait();
  std::int64_t missed() const { return missed_; }  // periods, since the start

 private:
  TickSchedule schedule_;
  std::int64_t missed_ = 0;
};

}  // namespace biopsy::realtime
