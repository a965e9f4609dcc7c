// Signals, what the kernel grants, and that a tick allocates nothing.
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "robot/live/realtime/become_realtime.hpp"
#include "robot/live/realtime/latency_histogram.hpp"
#include "robot/live/realtime/service_notice.hpp"
#include "robot/live/realtime/stop_signals.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "tests/robot/live/realtime/counting_allocator.hpp"

namespace biopsy::realtime {
namespace {

// In a child, so that neither memory locks nor precedence stay with the test. Returns the child's verdict.
int in_a_child(bool (*claim)()) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(claim() ? 0 : 1);
  int status = -1;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST(Background, IsOfTheThreadThatAsksAndWhatItStarts) {
  const auto own = [] { return ::getpriority(PRIO_PROCESS, 0); };
  const int before = own();
  int asked = 0, twice = 0, started = 0, beside = 0;
  std::thread([&] {
    run_in_background();
    asked = own();
    std::thread([&] { started = own(); }).join();
    run_in_background();
    twice = own();
  }).join();
  std::thread([&] { beside = own(); }).join();
  EXPECT_EQ(asked, std::max(before, kBackgroundNice));
  EXPECT_EQ(twice, asked);
  EXPECT_EQ(started, asked);
  EXPECT_EQ(beside, before);
  EXPECT_EQ(own(), before);
}

TEST(StopSignals, AreHeldUntilTheLoopAsks) {
  for (const int signal : {SIGTERM, SIGINT}) {
    StopSignals stop;
    EXPECT_FALSE(stop.came());
    ::raise(signal);
    EXPECT_EQ(stop.which(), 0) << "not asked yet";
    EXPECT_TRUE(stop.came());
    EXPECT_TRUE(stop.came()) << "it does not forget";
    EXPECT_EQ(stop.which(), signal);
  }
}

TEST(StopSignals, TheFirstThatArrivedIsTheOneThatCounts) {
  StopSignals stop;
  for (const int signal : {SIGTERM, SIGINT}) {
    ::raise(signal);
    EXPECT_TRUE(stop.came());
  }
  EXPECT_EQ(stop.which(), SIGTERM);
}

TEST(StopSignals, ReachTheLoopFromAnyThreadAndProcess) {
  StopSignals stop;
  std::thread([] { ::kill(::getpid(), SIGTERM); }).join();
  EXPECT_TRUE(stop.came());
}

TEST(StopSignals, KillAgainOnceNobodyAsks) {
  EXPECT_EQ(in_a_child([] {
              { const StopSignals stop; }
              ::raise(SIGTERM);
              return true;
            }),
            128 + SIGTERM);
}

TEST(BecomeRealtime, AsksForNothingUnasked) {
  const RealtimeObtained obtained = become_realtime({.lock_memory = false});
  EXPECT_EQ(obtained.memory, Grant::NotAsked);
  EXPECT_EQ(obtained.fifo, Grant::NotAsked);
  EXPECT_EQ(obtained.cpu, Grant::NotAsked);
  EXPECT_EQ(to_text(obtained), "nothing asked of the kernel");
}

TEST(BecomeRealtime, SaysTruthfullyWhatItObtained) {
  EXPECT_EQ(in_a_child([] {
              const int cpu = ::sched_getcpu();
              const RealtimeObtained obtained = become_realtime({.fifo_priority = 10, .cpu = cpu});
              const bool fifo = (::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO;
              cpu_set_t set;
              ::sched_getaffinity(0, sizeof set, &set);
              const bool bound = CPU_COUNT(&set) == 1 && CPU_ISSET(static_cast<unsigned>(cpu), &set);
              return obtained.memory != Grant::NotAsked && fifo == (obtained.fifo == Grant::Given) &&
                     obtained.cpu == Grant::Given && bound;
            }),
            0);
}

TEST(BecomeRealtime, GoesOnWithoutWhatIsRefusedAndSaysWhy) {
  EXPECT_EQ(in_a_child([] {
              const rlimit none{0, 0};
              ::setrlimit(RLIMIT_RTPRIO, &none);
              ::setrlimit(RLIMIT_MEMLOCK, &none);
              if (::geteuid() == 0 && ::seteuid(65'534) != 0) return false;
              const RealtimeObtained obtained = become_realtime({.fifo_priority = 10, .cpu = 5'000});
              return obtained.memory == Grant::Refused && obtained.fifo == Grant::Refused &&
                     obtained.cpu == Grant::Refused &&
                     to_text(obtained) ==
                         "memory lock refused, processor refused, SCHED_FIFO refused (memory lock: Cannot "
                         "allocate memory; processor 5000: Invalid argument; SCHED_FIFO: Operation not "
                         "permitted)";
            }),
            0);
}

// Out of the compiler's sight, which knows malloc and leaves out what is not used.
template <class Allocate, class Release>
std::uint64_t allocations_of(Allocate allocate, Release release) {
  static void* volatile got = nullptr;
  const AllocationCount count;
  got = allocate();
  release(got);
  return count.so_far();
}

struct alignas(128) Wide {
  char content[128];
};

TEST(AllocationCount, SeesEveryWayToAllocate) {
  const auto give_back = [](void* got) { std::free(got); };
  EXPECT_EQ(allocations_of([] { return nullptr; }, give_back), 0U);
  EXPECT_EQ(allocations_of([] { return std::malloc(10); }, give_back), 1U);
  EXPECT_EQ(allocations_of([] { return std::calloc(2, 10); }, give_back), 1U);
  EXPECT_EQ(allocations_of([] { return std::realloc(nullptr, 10); }, give_back), 1U);
#ifndef __SANITIZE_THREAD__  // which does not tell its listeners of this one
  EXPECT_EQ(allocations_of([] { return std::aligned_alloc(64, 64); }, give_back), 1U);
#endif
  EXPECT_EQ(allocations_of([] { return ::strdup("a name"); }, give_back), 1U) << "inside the C library";
  EXPECT_EQ(allocations_of([] { return new int; }, [](void* got) { delete static_cast<int*>(got); }), 1U);
  EXPECT_EQ(allocations_of([] { return new Wide; }, [](void* got) { delete static_cast<Wide*>(got); }), 1U);
}

TEST(AllocationCount, LeavesOutOtherThreads) {
  std::atomic<bool> begin = false, done = false;
  std::uint64_t there = 0;
  std::thread other([&] {
    while (!begin) std::this_thread::yield();
    there = allocations_of([] { return std::malloc(10); }, [](void* got) { std::free(got); });
    done = true;
  });
  const AllocationCount count;
  begin = true;
  while (!done) std::this_thread::yield();
  const std::uint64_t here = count.so_far();
  other.join();
  EXPECT_EQ(there, 1U);
  EXPECT_EQ(here, 0U);
}

TEST(RealtimeTick, AllocatesNothing) {
  StopSignals stop;
  const ServiceNotice notice;
  LatencyHistogram lateness;
  TickClock clock(std::chrono::microseconds(200));
  const AllocationCount count;
  for (int i = 0; i < 50 && !stop.came(); ++i) {
    lateness.record(clock.wait().late_ns());
    notice.watchdog();
    notice.status("ticks");
  }
  EXPECT_EQ(count.so_far(), 0U);
  EXPECT_EQ(lateness.count(), 50U);
}

}  // namespace
}  // namespace biopsy::realtime
