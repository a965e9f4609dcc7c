// SIGTERM and SIGINT, polled by a loop instead of interrupting it.
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

  // Whether one arrived since construction. One system call, no waiting, no allocation.
  bool came();
  // The first that arrived (SIGTERM or SIGINT); 0: none.
  int which() const { return first_; }

 private:
  sigset_t signals_{}, before_{};
  int first_ = 0;
};

}  // namespace biopsy::realtime
