// Loaded beside faketime, whose clock goes at a quarter of its speed: it hands the deadline of
// pthread_cond_clockwait, by which the standard library waits for a condition on the steady clock, to the
// kernel as it is, and the kernel's clock never gets there. Here the time that is left by the slowed clock
// becomes four times as much of the kernel's.
#include <dlfcn.h>
#include <pthread.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <ctime>

namespace {

constexpr std::int64_t kSlower = 4, kSecond_ns = 1'000'000'000;

std::int64_t ns_of(const timespec& time) {
  return time.tv_sec * kSecond_ns + time.tv_nsec;
}

}  // namespace

extern "C" int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                                      const timespec* until) {
  using Wait = int (*)(pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*);
  static const auto wait = reinterpret_cast<Wait>(dlsym(RTLD_NEXT, "pthread_cond_clockwait"));
  timespec slowed{}, kernel{};
  clock_gettime(clock, &slowed);
  syscall(SYS_clock_gettime, clock, &kernel);
  const std::int64_t left_ns = std::max<std::int64_t>(0, ns_of(*until) - ns_of(slowed));
  const std::int64_t until_ns = ns_of(kernel) + kSlower * std::min(left_ns, 3600 * kSecond_ns);
  const timespec kernel_until{until_ns / kSecond_ns, until_ns % kSecond_ns};
  return wait(condition, mutex, clock, &kernel_until);
}
