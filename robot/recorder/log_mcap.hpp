// The procedure log as MCAP: a topic for each kind of record, /log/state_change for example, and one for the
// rows of a run.csv, /run.
#pragma once

#include <string>
#include <vector>

#include "robot/common/files/csv_table.hpp"
#include "robot/recorder/record.hpp"

namespace biopsy::recorder {

// Of every record all that is hashed, texts byte by byte as far as they are UTF-8; where the body is a JSON
// object its fields again, as `values`, for plots. `run`: null, or the rows of a run; their time is that of
// the log where both went through the same states. Throws ConfigError where the log never went through those
// of the run.
std::string log_mcap(const std::vector<Record>& records, const CsvTable* run, const std::string& library);

}  // namespace biopsy::recorder
