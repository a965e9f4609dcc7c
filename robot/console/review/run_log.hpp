// The procedure log of a finished run, as entries on the run's time.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robot/msg/console_messages.hpp"

namespace biopsy::console {

struct RunLog {
  std::string note;  // a sentence: whether there is a log, whether it is intact, how it was placed in time
  std::vector<review::LogEntry> entries;  // from 10 s before the run to 10 s after it, in order
};

// `folder`: of the run, or of a run below that of a robot with a console (console/TIME/run-N). The log is
// verified against the key beside it and not changed. `spans`, `end_s`: of the run. A log that cannot be
// read or placed has no entries, and the note says why: the run can be reviewed without it.
RunLog read_run_log(const std::filesystem::path& folder, const std::vector<review::Span>& spans,
                    double end_s);

}  // namespace biopsy::console
