// The figures of a run from its samples: errors, overshoot, peak drive, and use of each limit.
#pragma once

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::robot {

// Fills the figures of `record` and of its steps from its samples, plan and checks.
// Settled: from kSettleTime after the setpoint arrived at a step's depth to the end of that step's hold,
// whatever the needle does in it. All: whenever the drive was active or held, against the moving setpoint.
void measure_run(report::RunRecord& record);

inline constexpr double kSettleTime_s =
    1.0;  // two periods of the square wave; the paper's steps settle within that

}  // namespace biopsy::robot
