// How long from a measurement published to the controller's request received, beside the bare bus.
#pragma once

#include "robot/live/session/live_options.hpp"

namespace biopsy::bench {

// 1 kHz, each round trip alone; with security and without. Prints p50, p99, max and the ratio.
void bench_loop(const robot::LiveOptions& options);

}  // namespace biopsy::bench
