// What every procedure begins and ends with, on whichever robot it runs.
#pragma once

#include <chrono>
#include <filesystem>

#include "robot/procedure/prepared_case.hpp"
#include "robot/procedure/procedure_options.hpp"
#include "robot/report/procedure/run_record.hpp"

namespace biopsy::robot {

// At the console a person may pick both points on the image.
enum class Points { Given, PickedLater };

// Throws ConfigError where the options do not fit together.
Case case_of(const ProcedureOptions& options, Points points = Points::Given);

// Writes the report and prints its table and path.
void finish(report::RunRecord& record, const PreparedCase& prepared, const std::filesystem::path& out,
            std::chrono::steady_clock::time_point started);

}  // namespace biopsy::robot
