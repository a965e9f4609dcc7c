// Where a report came from: versions, and hashes of everything that went in.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "robot/procedure/case/prepared_case.hpp"
#include "robot/report/procedure/run_record.hpp"

namespace biopsy::robot {

std::vector<std::pair<std::string, std::string>> provenance(const PreparedCase& prepared,
                                                            const report::RunRecord& record);

}  // namespace biopsy::robot
