// The run as CSV, one row a tick, units in the column names. The first columns are those of a recorded data
// set (row k: measured at time_s, then voltage_V was applied and held until the next row), so that a run can
// be read back as one. plate_b_mm and tip_mm exist in simulation only and are left out otherwise.
#pragma once

#include <filesystem>
#include <string>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

std::string run_csv(const RunRecord& record);
void save_run_csv(const RunRecord& record, const std::filesystem::path& path);

}  // namespace biopsy::report
