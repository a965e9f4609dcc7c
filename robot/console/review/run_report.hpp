// What the review page shows of a run's report.json.
#pragma once

#include <string>
#include <vector>

#include "robot/msg/console_messages.hpp"

namespace biopsy::console {

struct RunReport {
  std::string title, outcome, verdict;
  bool simulated = false;
  std::string seed;
  std::vector<review::Hazard> hazards;
  std::vector<review::ConfirmationImage> images;  // of the steps that have one; without pictures
};

// Entries that the page does not show are not looked at, so that reports of other versions are read. Throws
// ConfigError naming file and entry: no JSON, an entry missing, of another type or out of range, and a run
// that was refused: nothing moved.
RunReport parse_run_report(const std::string& text, const std::string& file_name);

}  // namespace biopsy::console
