// A kernel that grants what a test wants, linked in place of the C library's calls. Where no FakeKernel
// lives, the C library answers.
#pragma once

#include <sched.h>
#include <sys/resource.h>
#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace biopsy::realtime {

struct FakeKernel {
  FakeKernel();
  ~FakeKernel();
  FakeKernel(const FakeKernel&) = delete;
  FakeKernel& operator=(const FakeKernel&) = delete;

  // What it says: 0, or an error number.
  int lock_error = 0, schedule_error = 0, bind_error = 0;
  rlimit memory_limit{RLIM_INFINITY, RLIM_INFINITY};
  uid_t user = 1'000;

  // What it was asked for.
  std::vector<int> locked;              // flags
  std::vector<std::int64_t> sleeps_ns;  // until which absolute time
  std::vector<unsigned long> slacks_ns;
  std::optional<int> policy, priority;
  struct Nice {
    int of_what = -1, number = -1, value = -1;
  } nice;
  std::optional<pid_t> scheduled, bound_thread;
  std::vector<cpu_set_t> bound;

  // CLOCK_MONOTONIC; a sleep ends at its time, but for the first, which a signal may end `interrupted` times.
  std::int64_t now_ns = 0;
  int interrupted = 0;
};

}  // namespace biopsy::realtime
