// How late this machine wakes a real-time thread: the part of a live figure that is not the robot's.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "robot/realtime/become_realtime.hpp"
#include "robot/realtime/tick_clock.hpp"

namespace biopsy::live_tests {

constexpr double kSteady_ms =
    3.0;  // a robot whose machine stands still for longer stops by itself, and should

// What one processor's clock was late by, in sum, within any stretch of that length between two moments. A
// machine that takes a processor away, gives it back for a moment and takes it again is late by little each
// time, and what waits for the processor has lost the sum.
inline std::int64_t most_late_ns_within(std::int64_t stretch_ns, const std::vector<realtime::Wake>& wakes,
                                        std::int64_t from_ns, std::int64_t to_ns) {
  std::int64_t most = 0;
  for (const realtime::Wake& last : wakes) {
    if (last.woke_ns < from_ns || last.due_ns > to_ns) continue;
    std::int64_t sum = 0;
    for (const realtime::Wake& wake : wakes) {
      const std::int64_t begin = std::max(wake.due_ns, last.woke_ns - stretch_ns);
      const std::int64_t end = std::min(wake.woke_ns, last.woke_ns);
      sum += std::max<std::int64_t>(0, end - begin);
    }
    most = std::max(most, sum);
  }
  return most;
}

// A 2 kHz clock on every processor, above everything it judges (SCHED_FIFO 85 where permitted), while it
// lives. One clock alone would wander to the processor that is not held up.
class HostWatch {
 public:
  HostWatch() : late_(std::thread::hardware_concurrency()) {
    for (std::size_t cpu = 0; cpu < late_.size(); ++cpu)
      threads_.emplace_back([this, cpu](std::stop_token stop) { watch(stop, cpu); });
  }
  double worst_ms() const { return static_cast<double>(worst_ns_.load()) * 1e-6; }
  int stalls() const { return stalls_; }  // longer than kSteady_ms, on any processor
  void reset() {
    const std::scoped_lock lock(mutex_);
    worst_ns_ = stalls_ = 0;
    for (auto& wakes : late_) wakes.clear();
  }
  // The worst that any processor was late by between two moments of CLOCK_MONOTONIC: at once,
  double worst_ms_between(std::int64_t from_us, std::int64_t to_us) const {
    const std::scoped_lock lock(mutex_);
    std::int64_t worst_ns = 0;
    for (const auto& wakes : late_)
      for (const realtime::Wake& wake : wakes)
        if (wake.woke_ns >= from_us * 1000 && wake.due_ns <= to_us * 1000)
          worst_ns = std::max(worst_ns, wake.late_ns());
    return static_cast<double>(worst_ns) * 1e-6;
  }
  // and in sum, within any stretch of that length.
  double most_ms_within(std::int64_t stretch_us, std::int64_t from_us, std::int64_t to_us) const {
    const std::scoped_lock lock(mutex_);
    std::int64_t most_ns = 0;
    for (const auto& wakes : late_)
      most_ns =
          std::max(most_ns, most_late_ns_within(stretch_us * 1000, wakes, from_us * 1000, to_us * 1000));
    return static_cast<double>(most_ns) * 1e-6;
  }

 private:
  static constexpr std::int64_t kWorthKeeping_ns = 200'000;

  void note(const realtime::Wake& wake, std::size_t cpu) {
    if (static_cast<double>(wake.late_ns()) > kSteady_ms * 1e6) ++stalls_;
    if (wake.late_ns() > kWorthKeeping_ns) {
      const std::scoped_lock lock(mutex_);
      late_[cpu].push_back(wake);
    }
    std::int64_t worst_ns = worst_ns_.load();
    while (wake.late_ns() > worst_ns && !worst_ns_.compare_exchange_weak(worst_ns, wake.late_ns())) {
    }
  }

  void watch(const std::stop_token& stop, std::size_t cpu) {
    realtime::become_realtime({.lock_memory = false, .fifo_priority = 85, .cpu = static_cast<int>(cpu)});
    realtime::TickClock clock(std::chrono::microseconds(500));
    while (!stop.stop_requested()) note(clock.wait(), cpu);
  }

  mutable std::mutex mutex_;
  std::vector<std::vector<realtime::Wake>> late_;  // of each processor
  std::atomic<std::int64_t> worst_ns_{0};
  std::atomic<int> stalls_{0};
  std::vector<std::jthread> threads_;
};

}  // namespace biopsy::live_tests
