// How late this machine wakes a real-time thread: the part of a live figure that is not the robot's.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <numeric>
#include <string_view>
#include <thread>
#include <vector>

#include "robot/live/realtime/become_realtime.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::live_tests {

// A robot whose machine stands still for longer stops by itself, and should: wait for 3 ms, and
// a clock of 2 kHz feels a stall up to half a millisecond shorter than it is. Short stalls in a row hold work
// up as one long one does, and from whoever is not above everything they take more.
constexpr double kSteady_ms = 2.5;
constexpr int kInARow = 10;  // wakes, 5 ms: a tick's work is late by all that was withheld since it was due

// Where stalls kept a test from being judged, it is repeated with the clocks of its robot at these speeds.
inline constexpr std::array kClockSpeeds{0.25, 0.125};
inline constexpr std::string_view kJudgedWithSlowedClock = "judged with a slowed clock";

// Short stalls that stop a robot together: R-24 does so for three periods that were left out within 100 ms,
// each by a tick of the stage that came 0.75 ms late or more.
class LeftOutPeriods {
 public:
  // A clock of 2 kHz feels 0.25 to 0.75 ms of that. Shorter ones than these come so often, 1.4 times three a
  // second on a virtual machine on which the robot runs, that they would excuse any stop.
  static constexpr std::int64_t kLate_ns = 500'000;

  // Whether they are three with this wake, which was as late as that.
  bool with(std::int64_t woke_ns) {
    constexpr std::size_t kMost = 3;
    constexpr std::int64_t kPeriod_ns = 1'000'000, kWithin_ns = 100'000'000;
    if (!at_ns_.empty() && woke_ns - at_ns_.back() < kPeriod_ns)
      return false;  // the same, on another processor
    std::erase_if(at_ns_, [&](std::int64_t before_ns) { return woke_ns - before_ns > kWithin_ns; });
    at_ns_.push_back(woke_ns);
    const bool stops = at_ns_.size() >= kMost;
    if (stops) at_ns_.clear();
    return stops;
  }

 private:
  std::vector<std::int64_t> at_ns_;
};

// A 2 kHz clock on every processor, above everything it judges (SCHED_FIFO 85 where permitted), while it
// lives. One clock alone would wander to the processor that is not held up.
class HostWatch {
 public:
  HostWatch() {
    for (int cpu = 0; cpu < static_cast<int>(std::thread::hardware_concurrency()); ++cpu)
      threads_.emplace_back([this, cpu](std::stop_token stop) { watch(stop, cpu); });
  }
  double worst_ms() const { return static_cast<double>(worst_ns_.load()) * 1e-6; }
  // Longer than kSteady_ms in a row on any processor, or as many short ones as stop a robot.
  int stalls() const { return stalls_; }
  void reset() {
    const std::scoped_lock lock(mutex_);
    worst_ns_ = stalls_ = 0;
    late_.clear();
    left_out_ = {};
  }
  // The worst that any processor was late by between two moments of CLOCK_MONOTONIC.
  double worst_ms_between(std::int64_t from_us, std::int64_t to_us) const {
    const std::scoped_lock lock(mutex_);
    std::int64_t worst_ns = 0;
    for (const realtime::Wake& wake : late_)
      if (wake.woke_ns >= from_us * 1000 && wake.due_ns <= to_us * 1000)
        worst_ns = std::max(worst_ns, wake.late_ns());
    return static_cast<double>(worst_ns) * 1e-6;
  }

 private:
  static constexpr std::int64_t kWorthKeeping_ns = 500'000;

  // What a machine that is well needs for a wake is not withheld.
  static constexpr std::int64_t kOrdinary_ns = 200'000;

  struct Recent {  // one processor's last wakes
    std::array<std::int64_t, kInARow> withheld_ns{};
    std::size_t next = 0;
  };

  void note(const realtime::Wake& wake, Recent& recent) {
    recent.withheld_ns[recent.next++ % kInARow] = std::max<std::int64_t>(0, wake.late_ns() - kOrdinary_ns);
    const std::int64_t withheld_ns =
        std::accumulate(recent.withheld_ns.begin(), recent.withheld_ns.end(), std::int64_t{0});
    if (static_cast<double>(withheld_ns + kOrdinary_ns) > kSteady_ms * 1e6) ++stalls_, recent = {};
    if (wake.late_ns() >= LeftOutPeriods::kLate_ns) {
      const std::scoped_lock lock(mutex_);
      if (left_out_.with(wake.woke_ns)) ++stalls_;
    }
    if (wake.late_ns() > kWorthKeeping_ns) {
      const std::scoped_lock lock(mutex_);
      late_.push_back(wake);
    }
    std::int64_t worst_ns = worst_ns_.load();
    while (wake.late_ns() > worst_ns && !worst_ns_.compare_exchange_weak(worst_ns, wake.late_ns())) {
    }
  }

  void watch(const std::stop_token& stop, int cpu) {
    realtime::become_realtime({.lock_memory = false, .fifo_priority = 85, .cpu = cpu});
    realtime::TickClock clock(std::chrono::microseconds(500));
    Recent recent;
    while (!stop.stop_requested()) note(clock.wait(), recent);
  }

  mutable std::mutex mutex_;
  std::vector<realtime::Wake> late_;
  LeftOutPeriods left_out_;
  std::atomic<std::int64_t> worst_ns_{0};
  std::atomic<int> stalls_{0};
  std::vector<std::jthread> threads_;
};

}  // namespace biopsy::live_tests
