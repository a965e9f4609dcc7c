#include "robot/live/realtime/latency_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

namespace biopsy::realtime {
namespace {

TEST(LatencyHistogram, HasThePercentilesOfASort) {
  std::mt19937 random(9);
  for (const std::size_t records : {1U, 2U, 3U, 99U, 100U, 101U, 5'000U}) {
    std::lognormal_distribution<double> latency_ns(10.0, 2.0);  // 22 us at the median, ms in the tail
    LatencyHistogram histogram;
    std::vector<std::int64_t> sorted_us;
    for (std::size_t i = 0; i < records; ++i) {
      const auto ns = static_cast<std::int64_t>(latency_ns(random));
      histogram.record(ns);
      sorted_us.push_back(ns / 1'000);
    }
    std::sort(sorted_us.begin(), sorted_us.end());
    ASSERT_LT(sorted_us.back(), LatencyHistogram::kBuckets);
    for (const double share : {0.0, 0.01, 0.25, 0.5, 0.9, 0.99, 0.999, 1.0}) {
      const double rank = std::max(std::ceil(share * static_cast<double>(records)), 1.0);
      EXPECT_EQ(histogram.percentile_us(share), sorted_us[static_cast<std::size_t>(rank) - 1])
          << share << " of " << records;
    }
    EXPECT_EQ(histogram.max_us(), sorted_us.back());
    EXPECT_EQ(histogram.count(), records);
  }
}

TEST(LatencyHistogram, SaysNothingOfNothing) {
  const LatencyHistogram histogram;
  EXPECT_EQ(histogram.count(), 0U);
  EXPECT_EQ(histogram.p50_us(), 0);
  EXPECT_EQ(histogram.max_us(), 0);
}

TEST(LatencyHistogram, CountsWhatLiesOutsideItsBuckets) {
  LatencyHistogram histogram;
  histogram.record(-5'000);
  histogram.record(999);
  histogram.record(LatencyHistogram::kBuckets * 1'000 - 1'000);
  histogram.record(3'000'000'000);
  EXPECT_EQ(histogram.p50_us(), 0);
  EXPECT_EQ(histogram.percentile_us(1.0), 3'000'000);
  EXPECT_EQ(histogram.max_us(), 3'000'000);
  EXPECT_EQ(histogram.count(), 4U);
}

TEST(LatencyHistogram, IsExactUpToItsLastBucketButOne) {
  LatencyHistogram histogram;
  histogram.record((LatencyHistogram::kBuckets - 2) * 1'000);
  histogram.record(3'000'000'000);
  EXPECT_EQ(histogram.p50_us(), LatencyHistogram::kBuckets - 2);
}

TEST(LatencyHistogram, CanBeReadWhileItIsWritten) {
  LatencyHistogram histogram;
  constexpr std::uint64_t kRecords = 200'000;
  std::thread writer([&] {
    for (std::uint64_t i = 0; i < kRecords; ++i) histogram.record(static_cast<std::int64_t>(i % 100) * 1'000);
  });
  std::uint64_t before = 0;
  while (before < kRecords) {
    const std::uint64_t now = histogram.count();
    EXPECT_GE(now, before);
    EXPECT_LT(histogram.p99_us(), 100);
    before = now;
  }
  writer.join();
  EXPECT_EQ(histogram.p50_us(), 49);
}

}  // namespace
}  // namespace biopsy::realtime
