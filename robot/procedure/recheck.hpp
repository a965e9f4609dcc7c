// Safety margins of the built-in procedures, rehearsed with the old model of the stage and with the new one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robot/procedure/rehearsal.hpp"
#include "sim/gap/gap_finding.hpp"

namespace biopsy::robot {

struct Recheck {
  std::vector<MarginChange> margins;
  std::vector<std::string> warnings;  // which rehearsal did not come to its end, and why
};

// Each case with its own seed, images included. `ok`: the figure of the run with the new model is within its
// limit; "unplanned stops" also counts a procedure that did not complete. A figure that the new run did not
// reach is left out. A model without sensor noise gets `noise_mm`, with a warning: the supervisor takes a
// depth that never changes for a broken sensor. Uses a temporary folder. Throws ConfigError for files that
// are no models.
Recheck recheck(const std::filesystem::path& old_model, const std::filesystem::path& new_model,
                double noise_mm, const Progress& progress);

}  // namespace biopsy::robot
