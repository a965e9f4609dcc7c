// What a reader of bench data has to know, as sentences of the report.
#pragma once

#include "robot/common/units.hpp"
#include "robot/report/study/bench_report.hpp"

namespace biopsy::robot {

// Where the last run began, if elsewhere than the first: something stayed of what was done before.
void note_the_beginning(report::BenchRecord& record);

// Which runs lifted far less or far more than expected, and which --drive-scale could follow. `highest`: of
// all runs, at this scale.
void note_the_travel(report::BenchRecord& record, Volts highest, double drive_scale);

}  // namespace biopsy::robot
