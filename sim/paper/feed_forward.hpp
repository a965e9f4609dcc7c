// Model-based feed-forward for the paper's loop. Shown under "beyond", not in the figures' own rows.
#pragma once

#include "sim/paper/closed_loop.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::paper {

// Amplitude (V) that holds plate A at `depth` (mm): inverse of eq. (18)-(21) for the weight on the stack, and
// of eq. (7); leakage and retained charge within a half period are left to the loop. Zipping hysteresis is
// compensated for the direction of approach: `coming` +1 from below, -1 from above, 0 for none. At most
// `highest`, which is also returned for depths beyond the stroke; 0 at and below depth 0.
double holding_voltage(const PlantModel& stage, double depth, int coming, double highest = 8000.0);

// That voltage along a target, computed beforehand for each tick of a run of `seconds`, with the lead that
// the oil needs (tau_h dH/dt = H_eq - H solved for H_eq); jumps are left to the loop.
OfTime feed_forward(const PlantModel& stage, const OfTime& target, double seconds);

// The target limited to `speed` mm/s; computed beforehand.
OfTime rate_limited(const OfTime& target, double speed, double seconds);

}  // namespace biopsy::sim::paper
