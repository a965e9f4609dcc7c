// Claims about a robot in real time, on a machine that may stand still.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/robot/live/host_watch.hpp"

namespace biopsy::live_tests {

constexpr int kTrials = 4;
// A machine also stands still for one process alone, where its own host must first fetch a page of memory:
// no clock beside it sees that.
constexpr int kUnseenStalls = 1;

// A trial says what kept it from its claim, empty if nothing did: the robot stopped on its way, as it should
// where its machine stands still. It is tried again where the machine did so meanwhile, and once where nobody
// saw it; the second time it fails. Kept away in every trial, the test is skipped and says so. What the trial
// expects is never excused: a failure counts at once.
template <class Trial>
void on_a_steady_host(const Trial& trial) {
  std::string told;
  for (int n = 0, unseen = 0; n < kTrials; ++n) {
    const HostWatch host;
    const std::string kept_by = trial();
    if (kept_by.empty() || ::testing::Test::HasFailure()) return;
    told += fmt::format("trial {}, this machine {} ({:.1f} ms late at most): {}\n", n + 1,
                        host.stalls() > 0 ? "stood still" : "was steady", host.worst_ms(), kept_by);
    if (host.stalls() > 0) continue;
    ::testing::Test::RecordProperty("stopped_on_a_steady_host", ++unseen);
    if (unseen > kUnseenStalls) {
      ADD_FAILURE() << told;
      return;
    }
  }
  GTEST_SKIP() << "not judged:\n" << told;
}

}  // namespace biopsy::live_tests
