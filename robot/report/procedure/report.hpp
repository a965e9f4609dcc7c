// A run as files, for people and for programs. Two runs of one record give the same bytes; only report.json
// also holds the wall time, as wall_s.
#pragma once

#include <filesystem>
#include <string>

#include "robot/report/procedure/run_record.hpp"

namespace biopsy::report {

// report.html, report.json, run.csv (where something ran), planning.png and, for each step with images,
// axial.png, coronal.png, sagittal.png, stage-N-before.png, -after.png and -difference.png. Makes the folder.
// Throws ConfigError where it cannot write.
void save_report(const RunRecord& record, const std::filesystem::path& folder);

// One self-contained page for screen and A4: no script, nothing from a network. The verdict comes first.
std::string report_html(const RunRecord& record);

// The interface fields first, then additions. Unknown numbers are null.
std::string report_json(const RunRecord& record);

// One row a tick, units in the column names. The first columns are those of a recorded data set (row k:
// measured at time_s, then voltage_V was applied and held until the next row), so that a run can be read back
// as one. plate_b_mm and tip_mm exist in simulation only.
std::string run_csv(const RunRecord& record);

// The table that a command prints: patient and series, target, layers, steps, margins, verdict last. Plain
// UTF-8; with `colour` (a terminal) headings are bold and alarms red. Text from files cannot move the cursor.
std::string console_table(const RunRecord& record, bool colour);

}  // namespace biopsy::report
