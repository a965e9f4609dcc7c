#include "robot/live/realtime/become_realtime.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <system_error>

namespace biopsy::realtime {
namespace {

constexpr std::size_t kStack = std::size_t{256} * 1024;  // deeper than any tick goes

std::string reason(int error) {
  return std::generic_category().message(error);
}

// Under a limit (RLIMIT_MEMLOCK) a lock would make later allocations and threads fail: no lock then. Root has
// no limit.
int lock_memory() {
  rlimit limit{};
  ::getrlimit(RLIMIT_MEMLOCK, &limit);
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_MEMLOCK, &limit);
  if (limit.rlim_cur != RLIM_INFINITY && ::geteuid() != 0) return ENOMEM;
  return ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
}

[[gnu::noinline]] void touch_stack() {
  [[maybe_unused]] volatile std::byte stack[kStack];
  for (std::size_t at = 0; at < kStack; at += 1024) stack[at] = std::byte{0};
}

int schedule_fifo(int priority, bool threads_inherit) {
  const sched_param wanted{.sched_priority = priority};
  // By default threads and programs started from here run at ordinary priority.
  const int policy = threads_inherit ? SCHED_FIFO : SCHED_FIFO | SCHED_RESET_ON_FORK;
  return ::sched_setscheduler(0, policy, &wanted) == 0 ? 0 : errno;
}

int bind_to(int cpu) {
  if (cpu < 0 || cpu >= CPU_SETSIZE) return EINVAL;
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<unsigned>(cpu), &set);
  return ::sched_setaffinity(0, sizeof set, &set) == 0 ? 0 : errno;
}

}  // namespace

RealtimeObtained become_realtime(const RealtimeSettings& settings) {
  RealtimeObtained obtained;
  const auto granted = [&obtained](const char* what, int error) {
    if (error == 0) return Grant::Given;
    obtained.why_not += fmt::format("{}{}: {}", obtained.why_not.empty() ? "" : "; ", what, reason(error));
    return Grant::Refused;
  };
  if (settings.lock_memory) obtained.memory = granted("memory lock", lock_memory());
  touch_stack();
  if (settings.cpu)
    obtained.cpu = granted(fmt::format("processor {}", *settings.cpu).c_str(), bind_to(*settings.cpu));
  if (settings.fifo_priority != 0)
    obtained.fifo = granted("SCHED_FIFO", schedule_fifo(settings.fifo_priority, settings.threads_inherit));
  return obtained;
}

std::string to_text(const RealtimeObtained& obtained) {
  std::string text;
  const auto say = [&text](Grant grant, const char* what) {
    if (grant == Grant::NotAsked) return;
    text +=
        fmt::format("{}{} {}", text.empty() ? "" : ", ", what, grant == Grant::Given ? "granted" : "refused");
  };
  say(obtained.memory, "memory lock");
  say(obtained.cpu, "processor");
  say(obtained.fifo, "SCHED_FIFO");
  if (text.empty()) text = "nothing asked of the kernel";
  return obtained.why_not.empty() ? text : text + " (" + obtained.why_not + ")";
}

// Of one thread: Linux gives each its own nice value. Refused only where it is higher already, which is as
// good.
void run_in_background() {
  setpriority(PRIO_PROCESS, 0, kBackgroundNice);
}

}  // namespace biopsy::realtime
