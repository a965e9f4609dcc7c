// What every procedure begins and ends with, on whichever robot it runs.
#pragma once

#include <chrono>
#include <filesystem>

#include "robot/procedure/case/prepared_case.hpp"
#include "robot/procedure/procedure_options.hpp"
#include "robot/report/procedure/run_record.hpp"

namespace biopsy::robot {

// At the console a person may pick both points on the image.
enum class Points { Given, PickedLater };

// Throws ConfigError where the options do not fit together, an option would have no effect, or the case
// cannot be read.
Case case_of(const ProcedureOptions& options, Points points = Points::Given);

// Reads everything that the case names before `out` is cleared of an earlier run's files, `clearable`, or
// written to. Throws ConfigError with `out` untouched.
PreparedCase prepare_run(const Case& given, const std::filesystem::path& out,
                         const std::vector<std::string>& clearable);

// Writes the report; returns its table and path, for a terminal.
[[nodiscard]] std::string finish(report::RunRecord& record, const PreparedCase& prepared,
                                 const std::filesystem::path& out,
                                 std::chrono::steady_clock::time_point started);

}  // namespace biopsy::robot
