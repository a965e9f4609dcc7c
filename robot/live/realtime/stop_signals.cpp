#include "robot/live/realtime/stop_signals.hpp"

#include <ctime>

namespace biopsy::realtime {

StopSignals::StopSignals() {
  ::sigemptyset(&signals_);
  ::sigaddset(&signals_, SIGTERM);
  ::sigaddset(&signals_, SIGINT);
  ::pthread_sigmask(SIG_BLOCK, &signals_, &before_);
}

StopSignals::~StopSignals() {
  ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

bool StopSignals::came() {
  const timespec no_wait{};
  const int signal = ::sigtimedwait(&signals_, nullptr, &no_wait);
  if (first_ == 0 && signal > 0) first_ = signal;
  return first_ != 0;
}

}  // namespace biopsy::realtime
