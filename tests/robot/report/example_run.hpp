// One made-up but plausible record for every claim about the report: 2.0 mm, then 3.5 mm into layered tissue.
#pragma once

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

RunRecord example_run();      // completed, two stages, both confirmed by an image
RunRecord example_refusal();  // no plan, nothing moved
RunRecord example_stop();     // the completed run, cut short by a trip

}  // namespace biopsy::report
