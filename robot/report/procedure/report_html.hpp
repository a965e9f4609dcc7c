// The run as one self-contained page that a person reads and prints (A4): no script, nothing from a
// network. The verdict comes first. Two runs of one record give the same bytes: the wall time and the date
// are left out.
#pragma once

#include <filesystem>
#include <string>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

std::string report_html(const RunRecord& record);
void save_report_html(const RunRecord& record, const std::filesystem::path& path);

}  // namespace biopsy::report
