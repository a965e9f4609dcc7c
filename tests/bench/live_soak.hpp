// Hours of rehearsal compressed to minutes of real time: how often does the live robot stop for nothing?
#pragma once

#include "robot/live/session/live_options.hpp"
#include "robot/procedure/case/prepared_case.hpp"

namespace biopsy::bench {

// Rehearses the case again and again through the real processes; prints trips, and how late host and
// processes were.
void bench_soak(const robot::LiveOptions& options, const robot::PreparedCase& prepared, double minutes);

}  // namespace biopsy::bench
