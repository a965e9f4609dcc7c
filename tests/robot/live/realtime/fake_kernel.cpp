#include "tests/robot/live/realtime/fake_kernel.hpp"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <ctime>

namespace biopsy::realtime {
namespace {

FakeKernel* present = nullptr;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

// A call that succeeds may leave errno as it likes.
int answer(int error) {
  errno = error == 0 ? EDOM : error;
  return error == 0 ? 0 : -1;
}

}  // namespace

FakeKernel::FakeKernel() {
  present = this;
}

FakeKernel::~FakeKernel() {
  present = nullptr;
}

}  // namespace biopsy::realtime

using biopsy::realtime::answer;
using biopsy::realtime::kSecond_ns;
using biopsy::realtime::present;

extern "C" {

int mlockall(int flags) noexcept {
  if (present == nullptr) return static_cast<int>(::syscall(SYS_mlockall, flags));
  present->locked.push_back(flags);
  return answer(present->lock_error);
}

int setpriority(__priority_which_t of_what, id_t number, int value) noexcept {
  if (present == nullptr)
    return static_cast<int>(::syscall(SYS_setpriority, static_cast<int>(of_what), number, value));
  present->nice = {static_cast<int>(of_what), static_cast<int>(number), value};
  return 0;
}

int getrlimit(__rlimit_resource_t resource, rlimit* limit) noexcept {
  if (present == nullptr || resource != RLIMIT_MEMLOCK)
    return static_cast<int>(::syscall(SYS_prlimit64, 0, resource, nullptr, limit));
  *limit = present->memory_limit;
  return 0;
}

int setrlimit(__rlimit_resource_t resource, const rlimit* limit) noexcept {
  if (present == nullptr || resource != RLIMIT_MEMLOCK)
    return static_cast<int>(::syscall(SYS_prlimit64, 0, resource, limit, nullptr));
  present->memory_limit = *limit;
  return 0;
}

uid_t geteuid() noexcept {
  return present == nullptr ? static_cast<uid_t>(::syscall(SYS_geteuid)) : present->user;
}

int sched_setscheduler(pid_t pid, int policy, const sched_param* wanted) noexcept {
  if (present == nullptr) return static_cast<int>(::syscall(SYS_sched_setscheduler, pid, policy, wanted));
  present->scheduled = pid;
  present->policy = policy;
  present->priority = wanted->sched_priority;
  return answer(present->schedule_error);
}

int sched_setaffinity(pid_t pid, size_t size, const cpu_set_t* set) noexcept {
  if (present == nullptr) return static_cast<int>(::syscall(SYS_sched_setaffinity, pid, size, set));
  present->bound_thread = pid;
  present->bound.push_back(*set);
  return answer(present->bind_error);
}

int prctl(int option, ...) noexcept {
  std::va_list words;
  va_start(words, option);
  unsigned long given[4];
  for (unsigned long& word : given) word = va_arg(words, unsigned long);
  va_end(words);
  if (present != nullptr && option == PR_SET_TIMERSLACK) return present->slacks_ns.push_back(given[0]), 0;
  return static_cast<int>(::syscall(SYS_prctl, option, given[0], given[1], given[2], given[3]));
}

int clock_gettime(clockid_t clock, timespec* now) noexcept {
  if (present == nullptr || clock != CLOCK_MONOTONIC)
    return static_cast<int>(::syscall(SYS_clock_gettime, clock, now));
  *now = {present->now_ns / kSecond_ns, present->now_ns % kSecond_ns};
  return 0;
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* time, timespec* left) {
  if (present == nullptr) {
    const long failed = ::syscall(SYS_clock_nanosleep, clock, flags, time, left);
    return failed == 0 ? 0 : errno;
  }
  const std::int64_t until_ns = time->tv_sec * kSecond_ns + time->tv_nsec;
  if (clock != CLOCK_MONOTONIC || flags != TIMER_ABSTIME) return EINVAL;
  present->sleeps_ns.push_back(until_ns);
  if (present->interrupted > 0) return --present->interrupted, EINTR;
  present->now_ns = std::max(present->now_ns, until_ns);
  return 0;
}

}  // extern "C"
