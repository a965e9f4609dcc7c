#include "robot/common/in_parallel.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace biopsy {
namespace {

std::vector<double> sums(std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  std::vector<double> out(37);
  in_parallel(out.size(), [&](std::size_t i) {
    std::vector<double> parts(i);
    in_parallel(i, [&](std::size_t k) { parts[k] = std::sin(static_cast<double>(i * 100 + k)); });
    for (const double part : parts) out[i] += part;
  });
  return out;
}

TEST(InParallel, GivesTheSameBitsWithAnyNumberOfThreads) {
  const std::vector<double> alone = sums(1);
  for (const std::size_t threads : {2, 3, 8}) EXPECT_EQ(sums(threads), alone);
}

TEST(InParallel, VisitsEachIndexOnce) {
  std::vector<std::atomic<int>> visits(1000);
  in_parallel(visits.size(), [&](std::size_t i) { ++visits[i]; });
  for (const auto& count : visits) EXPECT_EQ(count, 1);
  in_parallel(0, [](std::size_t) { FAIL(); });
}

TEST(InParallel, ThrowsTheFailureOfTheLowestIndex) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
  for (int round = 0; round < 50; ++round) try {
      in_parallel(200, [](std::size_t i) {
        if (i % 30 == 17) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "17");
    }
}

}  // namespace
}  // namespace biopsy
