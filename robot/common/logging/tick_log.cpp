#include "robot/common/logging/tick_log.hpp"

#include <fmt/format.h>

#include <chrono>

#include "robot/common/logging/logger.hpp"
#include "robot/common/logging/signal_mask.hpp"

namespace biopsy::logging {
namespace {

constexpr std::chrono::milliseconds kEvery{50};

std::chrono::system_clock::time_point wall_time(std::int64_t monotonic_us) {
  const std::chrono::microseconds since_start{monotonic_us};
  const auto ago = std::chrono::steady_clock::now().time_since_epoch() - since_start;
  return std::chrono::system_clock::now() - std::chrono::duration_cast<std::chrono::microseconds>(ago);
}

}  // namespace

bool TickQueue::push(const TickRecord& record) noexcept {
  const std::size_t at = pushed_.load(std::memory_order_relaxed);
  if (at - popped_.load(std::memory_order_acquire) == kCapacity) {
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  records_[at % kCapacity] = record;
  pushed_.store(at + 1, std::memory_order_release);
  return true;
}

bool TickQueue::pop(TickRecord& record) noexcept {
  const std::size_t at = popped_.load(std::memory_order_relaxed);
  if (at == pushed_.load(std::memory_order_acquire)) return false;
  record = records_[at % kCapacity];
  popped_.store(at + 1, std::memory_order_release);
  return true;
}

TickLog::TickLog(Component component) : component_(component) {
  const SignalsBlocked blocked;
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

TickLog::~TickLog() {
  thread_.request_stop();
  thread_.join();
}

void TickLog::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    drain();
    std::unique_lock lock(mutex_);
    woken_.wait_for(lock, stop, kEvery, [] { return false; });
  }
  drain();
}

void TickLog::drain() {
  TickRecord record;
  while (queue_.pop(record)) {
    const auto& v = record.values;
    write(component_, record.event->level,
          fmt::vformat(fmt::string_view(record.event->text), fmt::make_format_args(v[0], v[1], v[2], v[3])),
          wall_time(record.time_us));
  }
  if (const std::uint64_t dropped = queue_.dropped(); dropped > dropped_) {
    write(component_, Level::Warning,
          fmt::format("{} records of ticks were dropped: their queue was full", dropped - dropped_));
    dropped_ = dropped;
  }
}

}  // namespace biopsy::logging
