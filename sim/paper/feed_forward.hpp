// What a controller that knows its stage can add to the paper's loop. Never part of a figure's own rows:
// shown beside them, under "beyond".
#pragma once

#include "sim/paper/closed_loop.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::paper {

// Amplitude (V) that holds plate A at `depth` (mm): eq. (18)-(21) solved backwards for the weight on the
// stack, and eq. (7) for the cable's share; what leaks or is retained within a half period is left to the
// loop. Zipping hysteresis is made up for on the side from which the depth is reached: `coming` +1 from
// below, -1 from above, 0 where it is not to be. At most `highest`, which is also the answer for depths
// beyond the stroke; 0 at and below depth 0.
double holding_voltage(const PlantModel& stage, double depth, int coming, double highest = 8000.0);

// That voltage along a target, worked out beforehand for each tick of a run of `seconds`. Where the target
// moves, as much more as the oil needs to keep up (tau_h dH/dt = H_eq - H solved for H_eq); jumps are left to
// the loop.
OfTime feed_forward(const PlantModel& stage, const OfTime& target, double seconds);

// The target, moving at most at `speed` mm/s; worked out beforehand.
OfTime rate_limited(const OfTime& target, double speed, double seconds);

}  // namespace biopsy::sim::paper
