// A weight laid on by hand: when it began to push is read from the depth.
#pragma once

#include <vector>

#include "sim/plant/dataset.hpp"

namespace biopsy::robot {

struct HandPush {
  double asked_s = 0.0;  // when somebody was asked for it, in the run's time
  double began_s = 0.0;  // when the depth began to follow; as asked where it never did
  double force_N = 0.0;  // from then on
  bool seen = false;
};

// Moves each change of `run.external_force` from when it was asked for to when the depth, compared with that
// of one drive period before (the oscillation repeats itself, a push does not), leaves the scatter that it
// had before the first of them, in the direction of the push: to some 50 ms, for a hand lays on as long, and
// friction holds. Looks until the next change, 6 s at most. A change that is not seen stays where it was.
// `period_rows`: rows of a drive period; `end`: the row behind the last that was under the program.
std::vector<HandPush> date_by_depth(sim::RecordedRun& run, std::size_t period_rows, std::size_t end);

}  // namespace biopsy::robot
