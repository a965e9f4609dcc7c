// Histogram of latencies in whole microseconds.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

namespace biopsy::realtime {

// One thread records while others read; no lock, no allocation after construction. Below zero counts as 0;
// from kBuckets us on only the maximum is exact.
class LatencyHistogram {
 public:
  static constexpr std::int64_t kBuckets = 32'768;  // us; beyond the 20 ms that anything here may take

  LatencyHistogram() : counts_(kBuckets) {}

  void record(std::int64_t latency_ns);

  std::uint64_t count() const;
  // Of all records the one at `share` (0..1) of them sorted, nearest rank, us; 0 without records.
  std::int64_t percentile_us(double share) const;
  std::int64_t p50_us() const { return percentile_us(0.50); }
  std::int64_t p99_us() const { return percentile_us(0.99); }
  std::int64_t max_us() const { return max_us_.load(std::memory_order_relaxed); }

 private:
  std::vector<std::atomic<std::uint32_t>> counts_;
  std::atomic<std::int64_t> max_us_{0};
};

}  // namespace biopsy::realtime
