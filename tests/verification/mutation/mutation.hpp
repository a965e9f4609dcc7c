// Switches of the mutated copy of safety/: mutant n is the one whose condition `on(n)` holds. One mutant is
// active in a process. It may be named by the environment, so that tables filled before main() are mutated as
// well.
#pragma once

#include <sys/mman.h>
#include <sys/time.h>

#include <cstddef>
#include <cstdlib>

namespace mutation {

inline constexpr int kRecording = -1;  // no mutant is active; those that are reached are noted
inline constexpr std::size_t kMostMutants = 1 << 14;

// Ends the process after so much processor time from now: a mutant that loops for ever is found out; and one
// that waits for ever after a time that no test takes on the busiest machine.
inline void limit_time(long milliseconds) {
  const itimerval patience{{0, 0}, {milliseconds == 0 ? 0 : 10 + milliseconds / 20, 0}};
  setitimer(ITIMER_REAL, &patience, nullptr);
  const itimerval limit{{0, 0}, {milliseconds / 1'000, milliseconds % 1'000 * 1'000}};
  setitimer(ITIMER_PROF, &limit, nullptr);
}

inline int active = [] {
  limit_time(5'000);
  const char* name = std::getenv("MUTANT");
  return name == nullptr ? 0 : std::atoi(name);
}();
// Shared with the processes that a test starts by fork.
inline bool* const reached = static_cast<bool*>(
    mmap(nullptr, kMostMutants, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));

inline bool on(int mutant) {
  if (active == kRecording) reached[mutant] = true;
  return active == mutant;
}

// What a static_assert of the original becomes: it kills before main().
inline bool must(bool holds) {
  if (!holds) std::abort();
  return holds;
}

}  // namespace mutation
