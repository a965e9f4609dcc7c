// Loaded beside faketime, whose clock goes at a share of its speed ("+0 x0.25" in FAKETIME): it hands the
// deadline of pthread_cond_clockwait, by which the standard library waits for a condition on the steady
// clock, to the kernel as it is, and the kernel's clock never gets there. Here the time that is left by the
// slowed clock becomes as much more of the kernel's.
#include <dlfcn.h>
#include <pthread.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

// How many seconds of the kernel's are one of the slowed clock's.
double slower() {
  const char* text = std::getenv("FAKETIME");
  const char* factor = text == nullptr ? nullptr : std::strchr(text, 'x');
  const double speed = factor == nullptr ? 1.0 : std::atof(factor + 1);
  return speed > 0.0 ? 1.0 / speed : 1.0;
}

std::int64_t ns_of(const timespec& time) {
  return time.tv_sec * kSecond_ns + time.tv_nsec;
}

}  // namespace

extern "C" int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                                      const timespec* until) {
  using Wait = int (*)(pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*);
  static const auto wait = reinterpret_cast<Wait>(dlsym(RTLD_NEXT, "pthread_cond_clockwait"));
  static const double times = slower();
  timespec slowed{}, kernel{};
  clock_gettime(clock, &slowed);
  syscall(SYS_clock_gettime, clock, &kernel);
  const std::int64_t left_ns = std::max<std::int64_t>(0, ns_of(*until) - ns_of(slowed));
  const auto left_of_kernel =
      static_cast<std::int64_t>(times * static_cast<double>(std::min(left_ns, 3600 * kSecond_ns)));
  const std::int64_t until_ns = ns_of(kernel) + left_of_kernel;
  const timespec kernel_until{until_ns / kSecond_ns, until_ns % kSecond_ns};
  return wait(condition, mutex, clock, &kernel_until);
}
