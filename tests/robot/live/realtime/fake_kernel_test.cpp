// What is asked of the kernel, exactly, and what is made of each answer: on a kernel that the test holds.
#include "tests/robot/live/realtime/fake_kernel.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <thread>
#include <vector>

#include "robot/live/realtime/become_realtime.hpp"
#include "robot/live/realtime/tick_clock.hpp"

namespace biopsy::realtime {
namespace {

constexpr RealtimeSettings kNothing{.lock_memory = false};

TEST(LockedMemory, IsAllOfItNowAndLaterWithTheHardLimitForASoftOne) {
  FakeKernel kernel;
  kernel.memory_limit = {8'192, RLIM_INFINITY};
  EXPECT_EQ(become_realtime({}).memory, Grant::Given);
  EXPECT_EQ(kernel.locked, std::vector<int>{MCL_CURRENT | MCL_FUTURE});
  EXPECT_EQ(kernel.memory_limit.rlim_cur, RLIM_INFINITY);
  EXPECT_EQ(kernel.memory_limit.rlim_max, RLIM_INFINITY);
}

// It would make a later allocation fail, in the middle of a procedure.
TEST(LockedMemory, IsNotTakenUnderALimitButByRootWhoHasNone) {
  FakeKernel kernel;
  kernel.memory_limit = {8'192, 65'536};
  const RealtimeObtained obtained = become_realtime({});
  EXPECT_EQ(obtained.memory, Grant::Refused);
  EXPECT_EQ(obtained.why_not, "memory lock: Cannot allocate memory");
  EXPECT_TRUE(kernel.locked.empty());
  EXPECT_EQ(kernel.memory_limit.rlim_cur, 65'536U);
  kernel.user = 0;
  EXPECT_EQ(become_realtime({}).memory, Grant::Given);
  EXPECT_EQ(kernel.locked.size(), 1U);
}

TEST(LockedMemory, ThatTheKernelRefusesIsReported) {
  FakeKernel kernel;
  kernel.lock_error = EPERM;
  const RealtimeObtained obtained = become_realtime({});
  EXPECT_EQ(obtained.memory, Grant::Refused);
  EXPECT_EQ(obtained.why_not, "memory lock: Operation not permitted");
  EXPECT_EQ(to_text(obtained), "memory lock refused (memory lock: Operation not permitted)");
}

TEST(Precedence, IsFirstInFirstOutAtThePriorityAskedFor) {
  FakeKernel kernel;
  RealtimeSettings settings = kNothing;
  settings.fifo_priority = 41;
  EXPECT_EQ(become_realtime(settings).fifo, Grant::Given);
  EXPECT_EQ(kernel.priority, 41);
  EXPECT_EQ(kernel.scheduled, 0) << "of the calling thread";
  EXPECT_EQ(kernel.policy, SCHED_FIFO | SCHED_RESET_ON_FORK) << "this thread alone";
  settings.threads_inherit = true;
  const RealtimeObtained obtained = become_realtime(settings);
  EXPECT_EQ(kernel.policy, SCHED_FIFO);
  EXPECT_TRUE(kernel.locked.empty());
  EXPECT_EQ(to_text(obtained), "SCHED_FIFO granted");
  kernel.schedule_error = EPERM;
  EXPECT_EQ(to_text(become_realtime(settings)), "SCHED_FIFO refused (SCHED_FIFO: Operation not permitted)");
}

TEST(Precedence, ThatIsNoneIsRefusedAndNotOverlooked) {
  FakeKernel kernel;
  kernel.schedule_error = EINVAL;
  RealtimeSettings settings = kNothing;
  settings.fifo_priority = -1;
  EXPECT_EQ(become_realtime(settings).fifo, Grant::Refused);
}

TEST(Precedence, UnaskedForIsLeftAsItIs) {
  FakeKernel kernel;
  become_realtime(kNothing);
  EXPECT_FALSE(kernel.policy);
}

TEST(OwnProcessor, IsTheOneAskedForAlone) {
  for (const int cpu : {0, 1, CPU_SETSIZE - 1}) {
    FakeKernel kernel;
    RealtimeSettings settings = kNothing;
    settings.cpu = cpu;
    const RealtimeObtained obtained = become_realtime(settings);
    EXPECT_EQ(obtained.cpu, Grant::Given);
    ASSERT_EQ(kernel.bound.size(), 1U);
    EXPECT_EQ(kernel.bound_thread, 0) << "the calling one";
    EXPECT_EQ(CPU_COUNT(&kernel.bound[0]), 1);
    EXPECT_TRUE(CPU_ISSET(static_cast<unsigned>(cpu), &kernel.bound[0]));
    EXPECT_EQ(to_text(obtained), "processor granted");
  }
}

TEST(OwnProcessor, ThatNoMachineHasIsNotAskedFor) {
  for (const int cpu : {-1, CPU_SETSIZE, CPU_SETSIZE + 1}) {
    FakeKernel kernel;
    RealtimeSettings settings = kNothing;
    settings.cpu = cpu;
    EXPECT_EQ(become_realtime(settings).why_not, "processor " + std::to_string(cpu) + ": Invalid argument");
    EXPECT_TRUE(kernel.bound.empty());
  }
  FakeKernel kernel;
  kernel.bind_error = EINVAL;
  RealtimeSettings settings = kNothing;
  settings.cpu = 3;
  EXPECT_EQ(become_realtime(settings).cpu, Grant::Refused);
}

// A new thread's stack is not there until it is touched.
TEST(Stack, IsThereBeforeTheFirstTick) {
  constexpr std::size_t kDeep = std::size_t{240} * 1024;
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  std::size_t before = 0, after = 0;
  const auto resident_below = [&](const char* here) {
    const auto top = reinterpret_cast<std::uintptr_t>(here) / page * page;
    std::vector<unsigned char> pages(kDeep / page);
    EXPECT_EQ(::mincore(reinterpret_cast<void*>(top - kDeep), kDeep, pages.data()), 0);
    return static_cast<std::size_t>(
        std::count_if(pages.begin(), pages.end(), [](unsigned char each) { return (each & 1U) != 0; }));
  };
  std::thread([&] {
    volatile char here = 0;
    before = resident_below(const_cast<char*>(&here));
    become_realtime(kNothing);
    after = resident_below(const_cast<char*>(&here));
  }).join();
  EXPECT_LT(before, 10U);
  EXPECT_EQ(after, kDeep / page);
}

TEST(TickClockOnAKernel, SleepsUntilEachAbsoluteTimeAlsoAfterASignal) {
  FakeKernel kernel;
  kernel.now_ns = 5'999'999'500;  // a second ends on the way
  kernel.interrupted = 2;
  TickClock clock(std::chrono::microseconds(1));
  EXPECT_EQ(kernel.slacks_ns, std::vector<unsigned long>{1}) << "the default of 50 us is for batteries";
  EXPECT_EQ(monotonic_ns(), 5'999'999'500);
  const Wake first = clock.wait();
  EXPECT_EQ(first.due_ns, 6'000'000'500);
  EXPECT_EQ(first.woke_ns, 6'000'000'500);
  EXPECT_EQ(first.missed, 0);
  EXPECT_EQ(clock.wait().due_ns, 6'000'001'500);
  EXPECT_EQ(kernel.sleeps_ns,
            (std::vector<std::int64_t>{6'000'000'500, 6'000'000'500, 6'000'000'500, 6'000'001'500}));
  EXPECT_EQ(monotonic_ns(), 6'000'001'500);
}

TEST(TickClockOnAKernel, CountsThePeriodsThatAStallTook) {
  FakeKernel kernel;
  TickClock clock(std::chrono::milliseconds(1));
  clock.wait();
  EXPECT_EQ(clock.missed(), 0);
  kernel.now_ns += 5'500'000;
  const Wake late = clock.wait();
  EXPECT_EQ(late.late_ns(), 4'500'000);
  EXPECT_EQ(late.missed, 4);
  kernel.now_ns += 3'500'000;
  EXPECT_EQ(clock.wait().missed, 3);
  EXPECT_EQ(clock.missed(), 7);
}

TEST(BackgroundOnAKernel, IsAskedForByTheCallingThreadOnly) {
  FakeKernel kernel;
  run_in_background();
  EXPECT_EQ(kernel.nice.of_what, PRIO_PROCESS);
  EXPECT_EQ(kernel.nice.number, 0);
  EXPECT_EQ(kernel.nice.value, kBackgroundNice);
}

}  // namespace
}  // namespace biopsy::realtime
