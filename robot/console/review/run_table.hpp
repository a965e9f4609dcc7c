// run.csv of a finished run: its numbers column by column, and what the supervisor decided as spans of time.
#pragma once

#include <string>
#include <vector>

#include "robot/msg/console_messages.hpp"

namespace biopsy::console {

struct RunTable {
  std::vector<std::string> columns;         // names with their unit; the first is time_s
  std::vector<std::vector<double>> values;  // of each column, one a row; all finite
  std::vector<review::Span> spans;          // the first begins with the first row
};

// The file's columns by name, in any order; what only a simulation knows (plate_b_mm, tip_mm) may be missing.
// Throws ConfigError naming file, line and column: a column that is missing or unknown, a number out of
// range, time that runs back, a name that no state has, more than kRowsMax rows.
inline constexpr std::size_t kRowsMax = 3'600'000;  // an hour
RunTable parse_run_table(std::string text, const std::string& file_name);

}  // namespace biopsy::console
