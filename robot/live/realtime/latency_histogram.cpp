#include "robot/live/realtime/latency_histogram.hpp"

#include <algorithm>
#include <cmath>

namespace biopsy::realtime {
void LatencyHistogram::record(std::int64_t latency_ns) {
  const std::int64_t latency_us = std::max(latency_ns, std::int64_t{0}) / 1'000;
  // One writer: no read-modify-write is needed.
  auto& bucket = counts_[static_cast<std::size_t>(std::min(latency_us, kBuckets - 1))];
  bucket.store(bucket.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  if (latency_us > max_us()) max_us_.store(latency_us, std::memory_order_relaxed);
}

std::uint64_t LatencyHistogram::count() const {
  std::uint64_t sum = 0;
  for (const auto& bucket : counts_) sum += bucket.load(std::memory_order_relaxed);
  return sum;
}

std::int64_t LatencyHistogram::percentile_us(double share) const {
  const std::uint64_t all = count();
  if (all == 0) return 0;
  const double rank = std::clamp(std::ceil(share * static_cast<double>(all)), 1.0, static_cast<double>(all));
  std::uint64_t seen = 0;
  for (std::int64_t us = 0; us < kBuckets - 1; ++us) {
    seen += counts_[static_cast<std::size_t>(us)].load(std::memory_order_relaxed);
    if (static_cast<double>(seen) >= rank) return us;
  }
  return max_us();  // among those beyond the buckets
}

}  // namespace biopsy::realtime
