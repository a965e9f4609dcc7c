// Ctrl-C during long work: the first asks it to end early with what is known, the second ends the program.
#pragma once

#include <stop_token>
#include <thread>

namespace biopsy {

// Blocks SIGINT and SIGTERM in the calling thread and in threads started later; make it before them. A thread
// of its own waits for both. One at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  // Stop is requested by the first signal.
  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::jthread waiting_;
};

}  // namespace biopsy
