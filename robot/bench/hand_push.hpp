// When a weight laid on by hand began to push, read from the depth.
#pragma once

#include <vector>

#include "sim/plant/dataset.hpp"

namespace biopsy::robot {

struct HandPush {
  double requested_s = 0.0;  // when the program requested it, in the run's time
  double began_s = 0.0;      // when the depth began to follow; as requested where it never did
  double force_N = 0.0;      // from then on
  bool seen = false;
};

// Moves each change of `run.external_force` from its request to when the depth first follows it.
// The depth is compared with that of one drive period before, which cancels the oscillation; a push is seen
// when the difference leaves its scatter before the first push, in the push's direction. Error: some 50 ms,
// the time a hand takes. The search ends at the next change, after 6 s at most; a change that is not seen
// stays as requested. `period_rows`: rows of a drive period; `end`: the row behind the last under the
// program.
std::vector<HandPush> date_by_depth(sim::RecordedRun& run, std::size_t period_rows, std::size_t end);

}  // namespace biopsy::robot
