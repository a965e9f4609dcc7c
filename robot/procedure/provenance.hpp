// Where a report came from: versions, and hashes of everything that went in.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "robot/procedure/case/prepared_case.hpp"
#include "robot/report/procedure/run_record.hpp"

namespace biopsy::robot {

std::vector<std::pair<std::string, std::string>> provenance(const PreparedCase& prepared,
                                                            const report::RunRecord& record);

// The same of a file of faults that are put into the run; empty for no file.
std::vector<std::pair<std::string, std::string>> provenance_of_faults(const std::filesystem::path& file);

}  // namespace biopsy::robot
