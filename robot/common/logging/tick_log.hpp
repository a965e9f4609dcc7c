// Log records from a control tick. Pushing one takes no lock, allocates nothing, formats nothing and makes no
// system call; a background thread turns records into messages of the component's logger.
#pragma once

#include <fmt/core.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <thread>

#include "robot/common/logging/level.hpp"

namespace biopsy::logging {

// What can happen in a tick: declare it constexpr and static. `text` names the values by their place, "{0}"
// to
// "{3}"; it is checked when it is compiled.
struct TickEvent {
  Level level;
  fmt::format_string<double, double, double, double> text;
};

struct TickRecord {
  const TickEvent* event = nullptr;
  std::int64_t time_us = 0;  // CLOCK_MONOTONIC
  std::array<double, 4> values{};
};

// Ring for one pushing and one popping thread, neither of which ever waits.
class TickQueue {
 public:
  static constexpr std::size_t kCapacity = 256;

  // False: full; the record is dropped and counted.
  bool push(const TickRecord& record) noexcept;
  bool pop(TickRecord& record) noexcept;
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  std::array<TickRecord, kCapacity> records_{};
  alignas(64) std::atomic<std::size_t> pushed_{0};
  alignas(64) std::atomic<std::size_t> popped_{0};
  std::atomic<std::uint64_t> dropped_{0};
};

class TickLog {
 public:
  explicit TickLog(Component component);  // starts the thread, which looks every 50 ms
  ~TickLog();                             // logs what is left
  TickLog(const TickLog&) = delete;
  TickLog& operator=(const TickLog&) = delete;

  // From one thread only: the tick's.
  void record(const TickEvent& event, std::int64_t time_us, double a = 0.0, double b = 0.0, double c = 0.0,
              double d = 0.0) noexcept {
    queue_.push({&event, time_us, {a, b, c, d}});
  }

 private:
  void drain();
  void run(const std::stop_token& stop);

  Component component_;
  TickQueue queue_;
  std::uint64_t dropped_ = 0;  // as reported
  std::mutex mutex_;           // the thread's sleep only
  std::condition_variable_any woken_;
  std::jthread thread_;  // last: everything it uses is there
};

}  // namespace biopsy::logging
