// Notes of a bench report: conditions under which its data must be read.
#pragma once

#include "robot/common/units.hpp"
#include "robot/report/study/bench_report.hpp"

namespace biopsy::robot {

// Where the last run began, if elsewhere than the first.
void note_the_beginning(report::BenchRecord& record);

// Which runs lifted far less or far more than expected, and which --drive-scale could follow. `highest`: of
// all runs, at this scale.
void note_the_travel(report::BenchRecord& record, Volts highest, double drive_scale);

}  // namespace biopsy::robot
