// Requests from the kernel what a control loop needs: locked memory, a pre-faulted stack, SCHED_FIFO, a
// processor of its own; and for work that may wait, that it runs behind such a loop. A refusal is not an
// error; it is reported.
#pragma once

#include <optional>
#include <string>

namespace biopsy::realtime {

struct RealtimeSettings {
  bool lock_memory = true;
  int fifo_priority = 0;         // SCHED_FIFO 1..99, not handed on to new threads; 0 = ordinary scheduling
  bool threads_inherit = false;  // threads and programs started afterwards inherit it
  std::optional<int> cpu{};      // bind the calling thread to this one
};

enum class Grant { NotAsked, Given, Refused };

struct RealtimeObtained {
  Grant memory = Grant::NotAsked, fifo = Grant::NotAsked, cpu = Grant::NotAsked;
  std::string why_not;  // the kernel's reasons for refusals; empty: none
};

// For the calling thread and, as to memory, the process. Before the first tick: it allocates and faults.
RealtimeObtained become_realtime(const RealtimeSettings& settings);

// One line for the log: "memory locked, SCHED_FIFO refused (Operation not permitted)".
std::string to_text(const RealtimeObtained& obtained);

constexpr int kBackgroundNice = 10;  // weighs a ninth; ordinary threads that wake run first
// For the calling thread, and threads and programs that it starts afterwards: image checks, reports,
// gateways. Where SCHED_FIFO is refused, they would otherwise delay the control loop by whole time slices.
void run_in_background();

}  // namespace biopsy::realtime
