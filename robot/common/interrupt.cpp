#include "robot/common/interrupt.hpp"

#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <ctime>

namespace biopsy {
namespace {

constexpr timespec kPoll{0, 50'000'000};  // how long the end of the work may have to wait

sigset_t both_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

}  // namespace

Interrupt::Interrupt() {
  const sigset_t signals = both_signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  waiting_ = std::jthread([source = source_, signals](std::stop_token over) mutable {
    while (!over.stop_requested()) {
      const int signal = sigtimedwait(&signals, nullptr, &kPoll);
      if (signal <= 0) continue;
      if (source.stop_requested()) _exit(128 + signal);
      std::fputs("\ninterrupted: ending with what is known; Ctrl-C again ends at once\n", stderr);
      source.request_stop();
    }
  });
}

Interrupt::~Interrupt() {
  waiting_.request_stop();
  waiting_.join();
  const sigset_t signals = both_signals();
  constexpr timespec kNow{};
  while (sigtimedwait(&signals, nullptr, &kNow) > 0) {  // came too late: the work is complete
  }
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
}

}  // namespace biopsy
