// The run's figure: depth against plan, drive voltage with its envelope and the supervisor's states on one
// time axis, with the stages shaded and images and trips marked. An SVG; empty where the run has no samples.
#pragma once

#include <string>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

std::string run_figure(const RunRecord& record);

}  // namespace biopsy::report
