// The report of the experiments on the bench.
#pragma once

#include <string>

#include "robot/report/study/bench_record.hpp"

namespace biopsy::report {

// A page that stands alone: what was done, a table, a picture of each run.
std::string bench_html(const BenchRecord& record);

// The table for a terminal, one line a run.
std::string bench_console(const BenchRecord& record);

}  // namespace biopsy::report
