// SIGTERM and SIGINT as a question that a loop asks, not as an interruption.
#pragma once

#include <csignal>

namespace biopsy::realtime {

// Blocks both signals while it lives, in the calling thread and in threads it starts afterwards: make it
// first in main. Programs started meanwhile inherit the block; give them a mask of their own.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  // Whether one came since construction. One system call, no waiting, no allocation.
  bool came();
  // The first that came (SIGTERM or SIGINT), 0 if none has.
  int which() const { return first_; }

 private:
  sigset_t signals_{}, before_{};
  int first_ = 0;
};

}  // namespace biopsy::realtime
