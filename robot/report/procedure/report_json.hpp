// The run as report.json: the interface fields first, then additions. Unknown numbers are null. Two runs of
// one record give the same bytes except for wall_s.
#pragma once

#include <filesystem>
#include <string>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

std::string report_json(const RunRecord& record);
void save_report_json(const RunRecord& record, const std::filesystem::path& path);

}  // namespace biopsy::report
