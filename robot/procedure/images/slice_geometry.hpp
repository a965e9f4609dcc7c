// Where the needle lies in a picture that is cut through it, as reports and pages draw it.
#pragma once

#include "planner/imaging/registration/reslice.hpp"
#include "robot/report/procedure/run_record.hpp"

namespace biopsy::robot {

report::SliceGeometry geometry_of(const imaging::NeedleSlice& slice);

}  // namespace biopsy::robot
