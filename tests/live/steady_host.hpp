// Judges a claim about a robot in real time by trials in which this machine ran on.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <exception>
#include <string>

#include "tests/live/host_watch.hpp"

namespace biopsy::live_tests {

constexpr int kTrials = 4;

// Tries until one trial is free of failures. A failure counts where the machine did not stand still during
// that trial; where it did so in every trial the test is skipped, and says so.
template <class Trial>
void on_a_steady_host(const Trial& trial) {
  std::string failures;
  double worst_ms = 0.0;
  int stalls = 0;
  for (int n = 0; n < kTrials; ++n) {
    ::testing::TestPartResultArray results;
    {
      const ::testing::ScopedFakeTestPartResultReporter kept(
          ::testing::ScopedFakeTestPartResultReporter::INTERCEPT_ALL_THREADS, &results);
      const HostWatch host;
      try {
        trial();
      } catch (const std::exception& error) {
        ADD_FAILURE() << error.what();
      }
      worst_ms = host.worst_ms();
      stalls = host.stalls();
    }
    failures.clear();
    for (int part = 0; part < results.size(); ++part) {
      const ::testing::TestPartResult& result = results.GetTestPartResult(part);
      if (result.failed()) failures += fmt::format("line {}: {}\n", result.line_number(), result.message());
    }
    if (failures.empty()) return;
    if (stalls == 0) {
      ADD_FAILURE() << failures << fmt::format("(this machine was late by {:.2f} ms at most)", worst_ms);
      return;
    }
  }
  GTEST_SKIP()
      << fmt::format("not judged: this machine stood still in each of {} trials, for {:.1f} ms in the last\n",
                     kTrials, worst_ms)
      << failures;
}

}  // namespace biopsy::live_tests
