// Everything a run leaves behind, in one folder: report.html, report.json, run.csv (where something ran),
// planning.png and, for each stage with images, stage-N-before.png and stage-N-after.png. Makes the folder.
// Throws ConfigError where it cannot write.
#pragma once

#include <filesystem>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

void save_report(const RunRecord& record, const std::filesystem::path& folder);

}  // namespace biopsy::report
